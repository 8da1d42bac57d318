// Samples of surfaces and the cells that they fill.
#include "engine/scene/layout/solid_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/math/quantile.h"
#include "engine/math/sh.h"
#include "engine/scene/scene.h"

namespace gse {
namespace {

constexpr double FaintOpacity = 0.05;  // fainter ones are no surface
constexpr double LargestArea = 0.95;   // quantile; larger splats count as this
constexpr double LogScaleReach = 30;   // beyond it exp() says nothing
constexpr double BoxShare = 0.02;      // of the weight at either end of an axis, outside the robust box
constexpr double BoxReach = 0.25;      // of the robust box: cells reach so far around it
constexpr double SolidShare = 0.97;    // of the weight, in the densest cells

SurfaceSample sample_of(const GaussianSpans& set, std::size_t row, std::size_t stride) {
    SurfaceSample sample;
    const float* p = &set.position[row * 3];
    sample.at = {p[0], p[1], p[2]};
    std::array<double, 3> scale{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        scale[axis] = std::exp(
            std::clamp(static_cast<double>(set.log_scale[row * 3 + axis]), -LogScaleReach, LogScaleReach));
    const auto shortest = static_cast<int>(std::min_element(scale.begin(), scale.end()) - scale.begin());
    const float* q = &set.rotation[row * 4];
    sample.normal = rotation_matrix({q[0], q[1], q[2], q[3]}).columns[shortest];
    std::sort(scale.begin(), scale.end());
    sample.flatness = 1 - scale[0] / scale[1];
    sample.weight = scale[1] * scale[2];
    for (std::size_t c = 0; c < 3; ++c)
        sample.colour[c] =
            std::clamp(colour_from_sh(static_cast<double>(set.sh[row * stride + c])), 0.0, 1.0);
    return sample;
}

/// Value below which `share` of the weight lies. `order` is a permutation of the samples.
double weighted_quantile(std::span<const SurfaceSample> samples, std::vector<std::uint32_t>& order, int axis,
                         double share, bool sort) {
    if (sort)
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return samples[a].at[axis] < samples[b].at[axis];
        });
    double total = 0, sum = 0;
    for (const auto& sample : samples) total += sample.weight;
    for (const auto i : order) {
        sum += samples[i].weight;
        if (sum >= share * total) return samples[i].at[axis];
    }
    return samples[order.back()].at[axis];
}

}  // namespace

std::vector<SurfaceSample> surface_samples(const GaussianSet& gaussians, std::size_t most,
                                           std::span<const std::uint8_t> skip) {
    const auto usable = usable_rows(gaussians);
    const GaussianSpans set = gaussians.spans();
    const auto least = static_cast<float>(std::log(FaintOpacity / (1 - FaintOpacity)));
    std::vector<std::uint32_t> rows;
    for (std::size_t row = 0; row < set.size; ++row)
        if (usable[row] != 0 && set.opacity_logit[row] > least && (skip.empty() || skip[row] == 0))
            rows.push_back(static_cast<std::uint32_t>(row));
    const std::size_t count = std::min(most, rows.size());
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(set.sh_degree)) * 3;
    std::vector<SurfaceSample> samples;
    std::vector<double> areas;
    std::vector<double> opacities;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t row = rows[i * rows.size() / count];
        samples.push_back(sample_of(set, row, stride));
        areas.push_back(samples.back().weight);
        opacities.push_back(1 / (1 + std::exp(-static_cast<double>(set.opacity_logit[row]))));
    }
    if (samples.empty()) return samples;
    const double largest = lower_quantile(areas, LargestArea);
    for (std::size_t i = 0; i < count; ++i)
        samples[i].weight = opacities[i] * std::min(samples[i].weight, largest);
    return samples;
}

SolidGrid::SolidGrid(std::span<const SurfaceSample> samples, int cells) {
    if (samples.empty()) return;
    std::vector<std::uint32_t> order(samples.size());
    std::iota(order.begin(), order.end(), 0U);
    Vec3 high;
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double first = weighted_quantile(samples, order, axis, BoxShare, true);
        const double last = weighted_quantile(samples, order, axis, 1 - BoxShare, false);
        low_[axis] = first - BoxReach * (last - first);
        high[axis] = last + BoxReach * (last - first);
        longest = std::max(longest, high[axis] - low_[axis]);
    }
    if (!(longest > 0)) return;
    side_ = longest / cells;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int a = static_cast<int>(axis);
        size_[axis] = static_cast<int>(std::ceil((high[a] - low_[a]) / side_)) + 1;
    }
    const auto count = static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                       static_cast<std::size_t>(size_[2]);
    std::vector<double> weight(count, 0);
    for (const auto& sample : samples) {
        Cell cell{};
        if (place(sample.at, cell)) weight[index(cell)] += sample.weight;
    }
    std::vector<double> filled;
    std::copy_if(weight.begin(), weight.end(), std::back_inserter(filled), [](double w) { return w > 0; });
    std::sort(filled.begin(), filled.end(), std::greater<>());
    const double enough = SolidShare * std::accumulate(filled.begin(), filled.end(), 0.0);
    double sum = 0, least = 0;
    for (std::size_t i = 0; i < filled.size() && sum < enough; ++i) sum += least = filled[i];
    solid_.resize(count);
    for (std::size_t i = 0; i < count; ++i) solid_[i] = weight[i] > 0 && weight[i] >= least ? 1 : 0;
    trim();
}

bool SolidGrid::place(const Vec3& at, Cell& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double place = std::floor((at[static_cast<int>(axis)] - low_[static_cast<int>(axis)]) / side_);
        if (!(place >= 0 && place < size_[axis])) return false;
        cell[axis] = static_cast<int>(place);
    }
    return true;
}

bool SolidGrid::find(const Vec3& at, Cell& cell) const { return place(at, cell) && solid(cell); }

void SolidGrid::trim() {
    Cell first = size_, last{-1, -1, -1}, cell{};
    const auto each = [&](const auto& call) {
        for (cell[0] = 0; cell[0] < size_[0]; ++cell[0])
            for (cell[1] = 0; cell[1] < size_[1]; ++cell[1])
                for (cell[2] = 0; cell[2] < size_[2]; ++cell[2])
                    if (solid(cell)) call();
    };
    each([&] {
        ++solid_count_;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            first[axis] = std::min(first[axis], cell[axis]);
            last[axis] = std::max(last[axis], cell[axis]);
        }
    });
    if (solid_count_ == 0) return solid_.clear();
    SolidGrid trimmed = *this;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        trimmed.size_[axis] = last[axis] - first[axis] + 1;
        trimmed.low_[static_cast<int>(axis)] += first[axis] * side_;
    }
    trimmed.solid_.assign(static_cast<std::size_t>(trimmed.size_[0]) *
                              static_cast<std::size_t>(trimmed.size_[1]) *
                              static_cast<std::size_t>(trimmed.size_[2]),
                          0);
    each([&] {
        trimmed.solid_[trimmed.index({cell[0] - first[0], cell[1] - first[1], cell[2] - first[2]})] = 1;
    });
    *this = std::move(trimmed);
}

}  // namespace gse
