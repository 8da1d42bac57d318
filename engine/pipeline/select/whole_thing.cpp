// A thing grown from the middle of a label, and the comparison of both.
#include "engine/pipeline/select/whole_thing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/localize/focus.h"
#include "engine/localize/grow_thing.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {
namespace {

constexpr double Steep = 0.5;           // cosine between up and an axis that it is turned from
constexpr double Solid = 0.5;           // opacity of a row to begin from
constexpr double LabelWithin = 0.9;     // of the label's opacity, that lies in the grown thing
constexpr double ThingLabelled = 0.75;  // of the grown thing's opacity, that the label holds

double opacity_of(const GaussianSpans& rows, std::size_t row) {
    return 1 / (1 + std::exp(-static_cast<double>(rows.opacity_logit[row])));
}

/// Places of the label's solid rows.
std::vector<Vec3> places_of(const GaussianSpans& rows, const std::vector<std::uint8_t>& usable,
                            const std::vector<std::uint8_t>& label) {
    std::vector<Vec3> places;
    for (std::size_t row = 0; row < rows.size; ++row) {
        const auto* at = &rows.position[3 * row];
        if (label[row] != 0 && usable[row] != 0 && opacity_of(rows, row) >= Solid)
            places.emplace_back(at[0], at[1], at[2]);
    }
    return places;
}

/// Places that the middle of pictures from two sides shows: at half the height, outermost, least aside.
std::vector<Vec3> seeds_of(const std::vector<Vec3>& places, const Vec3& up) {
    if (places.empty()) return {};
    const Vec3 axis = normalized(up);
    const Vec3 middle =
        std::accumulate(places.begin(), places.end(), Vec3{}) / static_cast<double>(places.size());
    const Vec3 across = std::abs(axis[0]) < Steep ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    const Vec3 right = normalized(cross(axis, across)), ahead = cross(right, axis);
    std::vector<Vec3> seeds;
    for (const Vec3& side : {right, ahead}) {
        const auto seen = [&](const Vec3& at) {
            const double out = dot(at - middle, side);
            return out - length(at - middle - side * out);
        };
        seeds.push_back(*std::max_element(places.begin(), places.end(),
                                          [&](const Vec3& a, const Vec3& b) { return seen(a) < seen(b); }));
    }
    return seeds;
}

/// Tells whether most of each is the other, by opacity.
bool same_thing(const GaussianSpans& rows, const std::vector<std::uint8_t>& usable,
                const std::vector<std::uint8_t>& label, const std::vector<std::uint8_t>& thing) {
    double of_label = 0, of_thing = 0, both = 0;
    for (std::size_t row = 0; row < rows.size; ++row) {
        if (usable[row] == 0) continue;
        const double opacity = opacity_of(rows, row);
        if (label[row] != 0) of_label += opacity;
        if (thing[row] != 0) of_thing += opacity;
        if (label[row] != 0 && thing[row] != 0) both += opacity;
    }
    return both > 0 && both >= LabelWithin * of_label && both >= ThingLabelled * of_thing;
}

}  // namespace

std::vector<std::uint8_t> whole_thing(const GaussianSet& set, const std::vector<std::uint8_t>& label,
                                      const OrbitParameters& orbit) {
    const auto rows = set.spans();
    const auto usable = usable_rows(set);
    const auto framed = localize::focus_orbit(set, label, orbit);
    localize::GrowRequest grow;
    grow.up = orbit.up;
    grow.extent = 2 * framed.radius * std::tan(framed.fov_x / 2);
    for (const Vec3& seed : seeds_of(places_of(rows, usable, label), orbit.up)) {
        grow.seed = seed;
        auto thing = localize::grow_thing(rows, grow).rows;
        if (same_thing(rows, usable, label, thing)) return thing;
    }
    return {};
}

}  // namespace gse::pipeline
