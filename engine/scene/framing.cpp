// Robust bounds of visible splats.
#include "engine/scene/framing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/math/quantile.h"
#include "engine/scene/layout/surroundings.h"
#include "engine/scene/scene.h"

namespace gse {
namespace {

constexpr double LeastOpacity = 1.0 / 255;  // fainter splats are not drawn
constexpr double RobustShare = 0.02;        // of the rows at either end of an axis
constexpr double OutermostShare = 0.002;    // of the rows at either end of an axis: never framed
constexpr double FloaterReach = 0.2;        // of the robust size: what lies farther out is not framed
constexpr double FramedDeviations = 2;      // of a middle-sized splat around its centre
constexpr double LogScaleLimit = 30;        // larger ones count as this, as in the rasterizer

/// As nearest_quantile.
double quantile(std::vector<float>& values, double share) {
    return static_cast<double>(nearest_quantile(values, share));
}

}  // namespace

double middle_size(std::vector<float>& log_scales) {
    return log_scales.empty() ? 0 : std::exp(std::min(quantile(log_scales, 0.5), LogScaleLimit));
}

Bounds framing_bounds(const GaussianSet& gaussians, std::span<const std::uint8_t> bits) {
    const auto usable = usable_rows(gaussians);
    const auto around = bits.empty() ? surrounding_rows(gaussians) : std::vector<std::uint8_t>{};
    const auto position = gaussians.position(), log_scale = gaussians.log_scale(),
               opacity = gaussians.opacity_logit();
    const auto least_logit = static_cast<float>(std::log(LeastOpacity / (1 - LeastOpacity)));
    std::vector<std::uint32_t> rows;
    std::vector<float> values;
    for (std::size_t row = 0;
         row < (bits.empty() ? gaussians.size() : std::min(gaussians.size(), bits.size())); ++row) {
        if (usable[row] == 0 || opacity[row] < least_logit || (!bits.empty() && bits[row] == 0) ||
            (!around.empty() && around[row] != 0))
            continue;
        rows.push_back(static_cast<std::uint32_t>(row));
        values.push_back(std::max({log_scale[row * 3], log_scale[row * 3 + 1], log_scale[row * 3 + 2]}));
    }
    Bounds bounds;
    if (rows.empty()) return bounds;
    const double margin = FramedDeviations * middle_size(values);
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < rows.size(); ++i)
            values[i] = position[rows[i] * std::size_t{3} + static_cast<std::size_t>(axis)];
        const double low = quantile(values, RobustShare), high = quantile(values, 1 - RobustShare);
        const double reach = FloaterReach * (high - low);
        bounds.low[axis] = std::max(quantile(values, OutermostShare), low - reach) - margin;
        bounds.high[axis] = std::min(quantile(values, 1 - OutermostShare), high + reach) + margin;
    }
    return bounds;
}

}  // namespace gse
