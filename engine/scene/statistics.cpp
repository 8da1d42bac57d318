// Defects of a scene, in two passes: find the odd rows and the bounds, then measure sizes against them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/math/quantile.h"
#include "engine/scene/framing.h"
#include "engine/scene/layout/surroundings.h"
#include "engine/scene/scene.h"

namespace gse {
namespace {

constexpr double InvisibleOpacity = 1.0 / 255.0;  // the rasterizer's smallest drawn alpha
constexpr double ZeroQuaternionNorm = 1e-8;
constexpr float LargestValue = 1e15f;  // its square is still far from what a float holds
constexpr float LargestColour = 1e4f;  // SH coefficient; trained ones stay below 100
constexpr double LowQuantile = 0.02;
constexpr double HighQuantile = 0.98;
constexpr double SplatReach = 3;  // standard deviations: what is seen of splats that are all in one place

constexpr float HiddenLogScale = -10, HiddenLogit = -100;  // of a row that is not to be seen

enum class Oddity { None, Nan, Infinite };

Oddity worse(Oddity a, Oddity b) { return a == Oddity::Nan || b == Oddity::None ? a : b; }

Oddity oddity(std::span<const float> values, float largest = LargestValue) {
    Oddity result = Oddity::None;
    for (const float value : values) {
        if (std::isnan(value)) return Oddity::Nan;
        if (std::abs(value) > largest) result = Oddity::Infinite;
    }
    return result;
}

/// True for infinities with a meaning: opacity logits of 0 or 1 exactly, and log-scales of -inf (a flat
/// axis).
Oddity row_oddity(const GaussianSpans& set, std::size_t row, std::size_t sh_stride) {
    Oddity result = worse(oddity(set.position.subspan(row * 3, 3)), oddity(set.rotation.subspan(row * 4, 4)));
    result = worse(result, oddity(set.sh.subspan(row * sh_stride, sh_stride), LargestColour));
    if (std::isnan(set.opacity_logit[row])) result = Oddity::Nan;
    for (const float value : set.log_scale.subspan(row * 3, 3)) {
        if (std::isnan(value)) result = Oddity::Nan;
        if (value > LargestValue) result = worse(result, Oddity::Infinite);
    }
    return result;
}

std::size_t sh_stride_of(const GaussianSpans& set) {
    return static_cast<std::size_t>(sh_coefficient_count(set.sh_degree)) * 3;
}

double sigmoid(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

struct Quantiles {
    double low = 0;
    double high = 0;
};

/// Reorders `values`, which must not be empty.
Quantiles quantiles(std::vector<float>& values) {
    const auto at = [&](double fraction) { return static_cast<double>(nearest_quantile(values, fraction)); };
    const double low = at(LowQuantile);
    return {low, at(HighQuantile)};
}

/// Fills both bounds. `visible` are the positions [M,3] of visible rows of the scene itself, `finite` those
/// of all finite rows.
void set_bounds(SceneStatistics& statistics, const std::vector<float>& finite,
                const std::vector<float>& visible) {
    if (finite.empty()) return;
    const std::vector<float>& robust = visible.empty() ? finite : visible;
    std::vector<float> axis_values(robust.size() / 3);
    for (int axis = 0; axis < 3; ++axis) {
        const auto offset = static_cast<std::size_t>(axis);
        float low = finite[offset], high = finite[offset];
        for (std::size_t i = offset; i < finite.size(); i += 3) {
            low = std::min(low, finite[i]);
            high = std::max(high, finite[i]);
        }
        statistics.bounds_low[axis] = low;
        statistics.bounds_high[axis] = high;
        for (std::size_t i = 0; i < axis_values.size(); ++i) axis_values[i] = robust[i * 3 + offset];
        const Quantiles found = quantiles(axis_values);
        statistics.robust_low[axis] = found.low;
        statistics.robust_high[axis] = found.high;
    }
}

std::size_t count_giants(const GaussianSpans& set, double robust_radius) {
    std::size_t giants = 0;
    for (std::size_t row = 0; row < set.size; ++row) {
        const float* s = set.log_scale.data() + row * 3;
        const double largest = std::exp(static_cast<double>(std::max({s[0], s[1], s[2]})));
        if (largest > robust_radius) ++giants;
    }
    return giants;
}

}  // namespace

SceneStatistics compute_statistics(const GaussianSet& gaussians) {
    const GaussianSpans set = gaussians.spans();
    const std::size_t sh_stride = sh_stride_of(set);
    SceneStatistics statistics;
    statistics.count = set.size;
    std::vector<float> finite;  // positions [M,3]
    VisibleRows visible;
    finite.reserve(set.size * 3);
    visible.reserve(set.size);
    double opacity_sum = 0;
    std::size_t opacity_count = 0;
    for (std::size_t row = 0; row < set.size; ++row) {
        const Oddity odd = row_oddity(set, row, sh_stride);
        if (odd == Oddity::Nan) ++statistics.nan_rows;
        if (odd == Oddity::Infinite) ++statistics.infinite_rows;
        const float* q = set.rotation.data() + row * 4;
        if (std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) < ZeroQuaternionNorm)
            ++statistics.zero_quaternion_rows;
        const double opacity = sigmoid(set.opacity_logit[row]);
        if (!std::isnan(opacity)) {
            opacity_sum += opacity;
            ++opacity_count;
        }
        if (opacity < InvisibleOpacity) ++statistics.invisible_rows;
        const auto position = set.position.subspan(row * 3, 3);
        if (oddity(position) != Oddity::None) continue;
        finite.insert(finite.end(), position.begin(), position.end());
        if (odd != Oddity::None || opacity < InvisibleOpacity) continue;
        visible.add(set, row);
    }
    statistics.visible_rows = visible.size();
    const Surroundings around = find_surroundings(visible);
    statistics.haze_rows = around.haze;
    statistics.sky_rows = around.sky;
    visible.drop(around.rows);
    if (opacity_count > 0) statistics.mean_opacity = opacity_sum / static_cast<double>(opacity_count);
    set_bounds(statistics, finite, visible.position);
    // Where the splats are larger than what their centres span, they are what is seen.
    const double splat_size = middle_size(visible.log_size);
    if (0.5 * length(statistics.robust_high - statistics.robust_low) < splat_size) {
        const Vec3 reach = Vec3{1, 1, 1} * (SplatReach * splat_size / std::sqrt(3.0));
        statistics.robust_low = statistics.robust_low - reach;
        statistics.robust_high = statistics.robust_high + reach;
    }
    const double robust_radius = 0.5 * length(statistics.robust_high - statistics.robust_low);
    if (robust_radius > 0) statistics.giant_rows = count_giants(set, robust_radius);
    return statistics;
}

std::vector<std::uint8_t> usable_rows(const GaussianSet& gaussians) {
    const GaussianSpans set = gaussians.spans();
    const std::size_t sh_stride = sh_stride_of(set);
    std::vector<std::uint8_t> keep(set.size);
    for (std::size_t row = 0; row < set.size; ++row)
        keep[row] = row_oddity(set, row, sh_stride) == Oddity::None ? 1 : 0;
    return keep;
}

GaussianSet drop_unusable(const GaussianSet& gaussians) {
    const auto keep = usable_rows(gaussians);
    return std::find(keep.begin(), keep.end(), 0) == keep.end() ? gaussians : gaussians.filtered(keep);
}

GaussianSet drawable(const GaussianSet& gaussians) {
    const auto usable = usable_rows(gaussians);
    if (std::find(usable.begin(), usable.end(), std::uint8_t{0}) == usable.end()) return gaussians;
    const SceneStatistics statistics = compute_statistics(gaussians);
    const Vec3 middle = 0.5 * (statistics.robust_low + statistics.robust_high);
    GaussianData data = gaussians.to_data();
    const auto set_all = [](std::vector<float>& values, std::size_t row, std::size_t stride, float value) {
        std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(row * stride), stride, value);
    };
    for (std::size_t row = 0; row < usable.size(); ++row) {
        if (usable[row] != 0) continue;
        if (oddity(std::span<const float>(data.position).subspan(row * 3, 3)) != Oddity::None)
            for (int axis = 0; axis < 3; ++axis)
                data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(middle[axis]);
        set_all(data.log_scale, row, 3, HiddenLogScale);
        set_all(data.rotation, row, 4, 0);
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = HiddenLogit;
        set_all(data.sh, row, data.sh_stride(), 0);
    }
    return GaussianSet(std::move(data));
}

}  // namespace gse
