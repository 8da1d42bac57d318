// Quantiles of labelled rows and of the ground around them.
#include "engine/edit/placement/upright_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"

namespace gse::edit {
namespace {

constexpr float ShownLogit = -5.5373f;  // opacity 1/255
constexpr double FootShare = 0.2;       // of a thing's height: the part that it stands on
constexpr double FootTrim = 0.1;        // of its rows, at either end
// Share of the width of what is above, beyond it: a label's rows that lie farther off are ground.
constexpr double FootReach = 0.25;
// Share of its height, up and down from its lowest rows: there is the ground that it stands on.
constexpr double GroundReach = 0.25;
// Share of the larger of height and width, down, where there is none so near: a label may lack the stem.
constexpr double StemReach = 0.8;
constexpr double GroundWidth = 1.5;  // of a foot's radius: so far out its ground is looked for at least
constexpr std::size_t LeastGroundRows = 20;  // rows that make a ground
constexpr double FigureWidth = 0.75;         // of its width, the least that a figure is high

std::vector<Vec3> shown_rows(const GaussianSet& set, std::span<const std::uint8_t> bits, const Frame& frame,
                             bool labelled) {
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        if ((bits[row] != 0) != labelled || !(set.opacity_logit()[row] > ShownLogit)) continue;
        const auto p = set.position().subspan(row * 3, 3);
        if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
            points.push_back(frame.to_frame({p[0], p[1], p[2]}));
    }
    return points;
}

/// Rows of a thing, by height.
struct Parts {
    double low = 0, high = 0;
    std::vector<Vec3> body, foot;
};

Parts parts_of(const std::vector<Vec3>& points) {
    Parts parts;
    const Box all = trimmed_box(points, BoundsTrim);
    parts.low = all.low.y, parts.high = all.high.y;
    for (const auto& p : points)
        (p.y > parts.low + FootShare * (parts.high - parts.low) ? parts.body : parts.foot).push_back(p);
    return parts;
}

bool is_below(const Vec3& p, const Box& body) {
    const Vec3 margin = body.size() * FootReach;
    return p.x >= body.low.x - margin.x && p.x <= body.high.x + margin.x && p.z >= body.low.z - margin.z &&
           p.z <= body.high.z + margin.z;
}

/// Height of the ground that carries `thing` at `foot`; the foot's where there is none. Ground reaches out
/// from under what stands on it: the end of a stem that a label lacks, or the lower side of a cap, does not.
double ground_at(const std::vector<Vec3>& others, const UprightBounds& thing, double foot_radius) {
    const double reach = std::max(0.5 * thing.width(), GroundWidth * foot_radius),
                 size = std::max(thing.height, thing.width());
    std::vector<double> near, below;
    for (const auto& p : others) {
        const double distance = std::hypot(p.x - thing.foot.x, p.z - thing.foot.z),
                     above = p.y - thing.foot.y;
        if (distance < foot_radius || distance > reach) continue;
        if (std::abs(above) <= GroundReach * thing.height) near.push_back(p.y);
        if (above < 0 && above >= -StemReach * size) below.push_back(p.y);
    }
    for (auto* ground : {&near, &below})
        if (ground->size() >= LeastGroundRows) return quantile(std::move(*ground), 0.5);
    return thing.foot.y;
}

}  // namespace

namespace {

UprightBounds stands(const GaussianSet& set, std::span<const std::uint8_t> bits, const Frame& frame,
                     bool on_ground) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const auto points = shown_rows(set, bits, frame, true);
    if (points.empty()) return {};
    auto parts = parts_of(points);
    const double height = parts.high - parts.low;
    if (parts.body.empty()) parts.body = points;  // as flat as a carpet
    Box thing = trimmed_box(parts.body, BoundsTrim);
    std::erase_if(parts.foot, [&](const Vec3& p) { return !is_below(p, thing); });
    Vec3 foot{thing.centre().x, parts.low, thing.centre().z};
    double foot_radius = 0;
    if (!parts.foot.empty()) {
        const Box below = trimmed_box(parts.foot, FootTrim);
        const Vec3 all = trimmed_box(parts.foot, BoundsTrim).size();
        foot_radius = 0.5 * std::hypot(all.x, all.z);
        foot.x = below.centre().x, foot.z = below.centre().z;
        for (const int axis : {0, 2}) {
            thing.low[axis] = std::min(thing.low[axis], below.low[axis]);
            thing.high[axis] = std::max(thing.high[axis], below.high[axis]);
        }
    }
    const Vec3 size = thing.size();
    if (on_ground)
        foot.y = ground_at(shown_rows(set, bits, frame, false), {foot, height, size.x, size.z}, foot_radius);
    return {frame.to_world(foot), parts.high - foot.y, size.x, size.z};
}

}  // namespace

UprightBounds standing_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                          const Vec3& front) {
    return stands(set, bits, make_frame(up, front), true);
}

UprightBounds standing_alone(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                             const Vec3& front) {
    return stands(set, bits, make_frame(up, front), false);
}

double figure_height(const UprightBounds& standing) {
    return std::max(standing.height, FigureWidth * standing.width());
}

}  // namespace gse::edit
