// A thing grown from the middle of a label, compared with it.
#include "engine/pipeline/select/whole_thing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/evaluate/metrics.h"
#include "engine/localize/focus.h"
#include "engine/localize/grow_thing.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {
namespace {

constexpr double Steep = 0.5;           // cosine between up and an axis that it is turned from
constexpr double Solid = 0.5;           // opacity of a row to begin from
constexpr double LabelWithin = 0.9;     // of the label's opacity, that lies in the grown thing
constexpr double ThingLabelled = 0.75;  // of the grown thing's opacity, that the label holds
constexpr double PartLabelled = 0.4;    // of a grown part's
constexpr double WearerSize = 3;        // of what it wears: a hat is a third of a figure

/// [N] 0 for rows that are not usable.
std::vector<double> opacities(const GaussianSet& set) {
    std::vector<double> opacity(set.size(), 0);
    const auto usable = usable_rows(set);
    for (std::size_t row = 0; row < set.size(); ++row)
        if (usable[row] != 0)
            opacity[row] = 1 / (1 + std::exp(-static_cast<double>(set.opacity_logit()[row])));
    return opacity;
}

/// Places of the label's solid rows.
std::vector<Vec3> places_of(const GaussianSpans& rows, const std::vector<double>& opacity,
                            const std::vector<std::uint8_t>& label) {
    std::vector<Vec3> places;
    for (std::size_t row = 0; row < rows.size; ++row) {
        const auto* at = &rows.position[3 * row];
        if (label[row] != 0 && opacity[row] >= Solid) places.emplace_back(at[0], at[1], at[2]);
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

}  // namespace

std::vector<std::uint8_t> whole_thing(const GaussianSet& set, const std::vector<std::uint8_t>& label,
                                      const OrbitParameters& orbit, bool part) {
    const auto rows = set.spans();
    const auto opacity = opacities(set);
    const auto framed = localize::focus_orbit(set, label, orbit);
    localize::GrowRequest grow;
    grow.up = orbit.up, grow.part = part;
    grow.extent = (part ? WearerSize : 1) * 2 * framed.radius * std::tan(framed.fov_x / 2);
    for (const Vec3& seed : seeds_of(places_of(rows, opacity, label), orbit.up)) {
        grow.seed = seed;
        auto thing = localize::grow_thing(rows, grow).rows;
        const auto overlap = evaluate::row_overlap(label, thing, opacity);
        if (overlap.precision >= LabelWithin && overlap.recall >= (part ? PartLabelled : ThingLabelled))
            return thing;
    }
    return {};
}

}  // namespace gse::pipeline
