// Rows with their axes; the box of most of a thing.
#include "engine/heal/surface_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/math/quantile.h"
#include "engine/math/sh.h"

namespace gse::heal {
namespace {

constexpr double LeastOpacity = 0.04;  // fainter ones show nothing
constexpr double LogScaleReach = 30;   // beyond it exp() says nothing
constexpr double StrayShare = 0.02;    // of the rows at either end of an axis that do not widen the box
constexpr double BoxSlack = 0.1;       // of the box of the others, by which it is grown
constexpr std::size_t BallPoints = 600;

SurfaceRow surface_row(const GaussianSpans& set, std::size_t row) {
    SurfaceRow one;
    one.row = static_cast<std::uint32_t>(row);
    const float* p = &set.position[row * 3];
    one.at = {p[0], p[1], p[2]};
    const float* q = &set.rotation[row * 4];
    const Mat3 turn = rotation_matrix({q[0], q[1], q[2], q[3]});
    for (std::size_t k = 0; k < 3; ++k) {
        one.axis[k] = turn.columns[static_cast<int>(k)];
        one.scale[k] = std::exp(
            std::clamp(static_cast<double>(set.log_scale[row * 3 + k]), -LogScaleReach, LogScaleReach));
    }
    auto sorted = one.scale;
    std::sort(sorted.begin(), sorted.end());
    const auto shortest = std::min_element(one.scale.begin(), one.scale.end()) - one.scale.begin();
    one.normal = one.axis[static_cast<std::size_t>(shortest)];
    one.flatness = sorted[1] > 0 ? 1 - sorted[0] / sorted[1] : 0;
    one.opacity = 1 / (1 + std::exp(-static_cast<double>(set.opacity_logit[row])));
    one.weight = one.opacity * sorted[1] * sorted[2];
    const std::size_t stride = static_cast<std::size_t>(sh_coefficient_count(set.sh_degree)) * 3;
    for (int c = 0; c < 3; ++c)
        one.colour[c] = colour_from_sh(set.sh[row * stride + static_cast<std::size_t>(c)]);
    return one;
}

}  // namespace

std::vector<SurfaceRow> surface_rows(const GaussianSet& gaussians, std::span<const std::uint8_t> usable,
                                     const std::function<bool(std::size_t, const Vec3&)>& wanted) {
    const GaussianSpans set = gaussians.spans();
    const auto least = static_cast<float>(std::log(LeastOpacity / (1 - LeastOpacity)));
    std::vector<SurfaceRow> rows;
    for (std::size_t row = 0; row < set.size; ++row) {
        if (usable[row] == 0 || !(set.opacity_logit[row] > least)) continue;
        const float* p = &set.position[row * 3];
        if (wanted(row, {p[0], p[1], p[2]})) rows.push_back(surface_row(set, row));
    }
    return rows;
}

bool Body::near(const Vec3& at, double margin) const {
    for (int k = 0; k < 3; ++k)
        if (!(at[k] >= low[k] - margin && at[k] <= high[k] + margin)) return false;
    return true;
}

Body body_of(std::span<const SurfaceRow> thing) {
    Body body;
    if (thing.empty()) return body;
    std::vector<double> values(thing.size());
    const auto quantile = [&](double share) { return nearest_quantile(values, share); };
    for (int k = 0; k < 3; ++k) {
        std::transform(thing.begin(), thing.end(), values.begin(),
                       [k](const auto& row) { return row.at[k]; });
        const double first = quantile(StrayShare), last = quantile(1 - StrayShare);
        body.low[k] = first - BoxSlack * (last - first);
        body.high[k] = last + BoxSlack * (last - first);
    }
    body.size = length(body.high - body.low);
    for (const auto& row : thing)
        if (body.near(row.at, 0)) body.points.push_back(row.at), body.weight += row.weight;
    if (body.size > 0 || body.points.empty()) return body;
    // A single Gaussian is as large as it is seen.
    return ball_body(thing[0].at, 2 * thing[0].longest());
}

Body ball_body(const Vec3& centre, double radius) {
    constexpr double Golden = 2.399963229728653;  // golden angle
    Body body;
    body.low = centre - Vec3(radius);
    body.high = centre + Vec3(radius);
    body.size = 2 * radius;
    for (std::size_t i = 0; i < BallPoints; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / BallPoints, z = 1 - 2 * share;
        const double r = std::sqrt(1 - z * z), turn = Golden * static_cast<double>(i);
        for (const double shell : {0.33, 0.66, 1.0})
            body.points.push_back(centre + radius * shell * Vec3{r * std::cos(turn), r * std::sin(turn), z});
    }
    body.weight = std::numbers::pi * radius * radius;
    return body;
}

}  // namespace gse::heal
