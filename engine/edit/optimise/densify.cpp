// Clone, split and prune of labelled rows (3DGS adaptive density control under GaussianEditor's percent
// rule).
#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/random.h"
#include "engine/edit/optimise/working_set.h"

namespace gse::edit {
namespace {

constexpr double SplitShrink = 1.6;
constexpr int SplitChildren = 2;
// An original splat counts as grown beyond this times its scale at load (METHOD.md, Densification)
constexpr double GrownFactor = 2;

}  // namespace

float WorkingSet::largest_scale(std::size_t index) const {
    const float* scale = &table_.rows.log_scale[(first_row() + index) * 3];
    return std::max({scale[0], scale[1], scale[2]});
}

bool WorkingSet::prunable(std::size_t index, const LoopSettings& settings) const {
    const double opacity =
        1 / (1 + std::exp(-static_cast<double>(table_.rows.opacity_logit[first_row() + index])));
    if (opacity < settings.min_opacity) return true;
    const float scale = largest_scale(index);
    if (std::exp(scale) <= settings.prune_scale * extent_) return false;
    return scale > table_.birth_scale[index] + std::log(GrownFactor);
}

std::vector<std::size_t> WorkingSet::densify_candidates(const LoopSettings& settings) const {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t i = 0; i < labelled(); ++i) {
        const double gradient = table_.gradient_sum[i] / std::max(1u, table_.gradient_count[i]);
        if (gradient > 0) ranked.emplace_back(-gradient, i);
    }
    auto count =
        static_cast<std::size_t>(std::ceil(settings.densify_percent * static_cast<double>(ranked.size())));
    const auto limit = static_cast<std::size_t>(settings.max_growth * static_cast<double>(start_count_));
    count = std::min({count, ranked.size(), limit > labelled() ? limit - labelled() : 0});
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < count; ++i)
        if (-ranked[i].first >= settings.densify_min_gradient) chosen.push_back(ranked[i].second);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

void WorkingSet::split(std::size_t index, int generation, Random& random) {
    GaussianData parent;
    parent.sh_degree = table_.rows.sh_degree;
    parent.append_row(table_.rows, first_row() + index);
    const auto& q = parent.rotation;
    const Mat3 frame = rotation_matrix({q[0], q[1], q[2], q[3]});
    GaussianData child = parent;
    for (int k = 0; k < SplitChildren; ++k) {
        Vec3 offset;
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            offset[axis] = random.normal() * std::exp(static_cast<double>(parent.log_scale[i]));
            child.log_scale[i] = parent.log_scale[i] - static_cast<float>(std::log(SplitShrink));
        }
        const Vec3 moved = frame * offset;
        for (int axis = 0; axis < 3; ++axis)
            child.position[static_cast<std::size_t>(axis)] =
                parent.position[static_cast<std::size_t>(axis)] + static_cast<float>(moved[axis]);
        append_child(index, child, generation);
    }
}

std::size_t WorkingSet::keep_added(std::span<const float> weight, std::span<const double> evidence,
                                   double least_weight, double least_left) {
    GSE_CHECK_EQ(weight.size(), table_.rows.size());
    std::vector<std::uint8_t> keep(labelled(), 1);
    std::size_t added = 0, dropped = 0;
    for (std::size_t i = 0; i < labelled(); ++i) {
        if (table_.ancestor[i] >= 0) continue;
        ++added;
        if (evidence[first_row() + i] <= 0 || weight[first_row() + i] >= least_weight) continue;
        keep[i] = 0;
        ++dropped;
    }
    if (dropped == 0 || static_cast<double>(added - dropped) < least_left * static_cast<double>(added))
        return 0;
    table_.keep(keep);
    remember_anchor();
    return dropped;
}

DensifyCount WorkingSet::densify(const LoopSettings& settings, Random& random, bool may_grow) {
    DensifyCount count;
    std::vector<std::size_t> chosen;
    if (may_grow) chosen = densify_candidates(settings);
    table_.reserve(SplitChildren * chosen.size());  // the densification either happens or changes nothing
    const int generation = schedule_.advance();
    std::vector<std::uint8_t> keep(labelled(), 1);
    for (const std::size_t index : chosen) {
        if (std::exp(largest_scale(index)) > settings.percent_dense * extent_) {
            split(index, generation, random);
            keep[index] = 0;
            ++count.split;
            continue;
        }
        GaussianData copy;
        copy.sh_degree = table_.rows.sh_degree;
        copy.append_row(table_.rows, first_row() + index);
        append_child(index, copy, generation);
        ++count.cloned;
    }
    keep.resize(labelled(), 1);
    for (std::size_t i = 0; i < labelled(); ++i)
        if (keep[i] != 0 && prunable(i, settings)) {
            keep[i] = 0;
            ++count.pruned;
        }
    table_.keep(keep);
    table_.clear_working();
    remember_anchor();
    return count;
}

}  // namespace gse::edit
