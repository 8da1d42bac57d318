// Clone, split and prune of labelled rows (3DGS adaptive density control under GaussianEditor's percent rule).
#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/random.h"
#include "engine/edit/working_set.h"

namespace gse::edit {
namespace {

constexpr double SplitShrink = 1.6;
constexpr int SplitChildren = 2;
constexpr double GrownFactor = 2;   // an original splat counts as grown beyond this times its scale at load (F8)

/// Drops the rows of a labelled-only array whose keep flag is 0.
template <class T>
void compact(std::vector<T>& values, const std::vector<std::uint8_t>& keep, std::size_t begin, std::size_t stride) {
    std::size_t to = begin * stride;
    if (values.size() <= to) return;   // moments before the first step
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] == 0) continue;
        for (std::size_t k = 0; k < stride; ++k) values[to++] = values[(begin + i) * stride + k];
    }
    values.resize(to);
}

}  // namespace

void WorkingSet::keep_rows(const std::vector<std::uint8_t>& keep) {
    const std::size_t sh = rows_.sh_stride();
    compact(rows_.position, keep, first_row_, 3);
    compact(rows_.log_scale, keep, first_row_, 3);
    compact(rows_.rotation, keep, first_row_, 4);
    compact(rows_.opacity_logit, keep, first_row_, 1);
    compact(rows_.sh, keep, first_row_, sh);
    compact(origin_, keep, 0, 1);
    compact(ancestor_, keep, 0, 1);
    compact(generation_, keep, 0, 1);
    compact(birth_sh_, keep, 0, sh);
    compact(birth_scale_, keep, 0, 1);
    compact(gradient_sum_, keep, 0, 1);
    compact(gradient_count_, keep, 0, 1);
    for (auto* moments : {&position_.first, &position_.second, &log_scale_.first, &log_scale_.second})
        compact(*moments, keep, 0, 3);
    for (auto* moments : {&rotation_.first, &rotation_.second}) compact(*moments, keep, 0, 4);
    for (auto* moments : {&opacity_.first, &opacity_.second}) compact(*moments, keep, 0, 1);
    for (auto* moments : {&sh_.first, &sh_.second}) compact(*moments, keep, 0, sh);
}

bool WorkingSet::prunable(std::size_t index, const EditRequest& request) const {
    const std::size_t row = first_row_ + index;
    const double opacity = 1 / (1 + std::exp(-static_cast<double>(rows_.opacity_logit[row])));
    if (opacity < request.min_opacity) return true;
    const float scale =
        std::max({rows_.log_scale[row * 3], rows_.log_scale[row * 3 + 1], rows_.log_scale[row * 3 + 2]});
    if (std::exp(scale) <= request.prune_scale * extent_) return false;
    return scale > birth_scale_[index] + std::log(GrownFactor);
}

std::vector<std::size_t> WorkingSet::densify_candidates(const EditRequest& request) const {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t i = 0; i < labelled(); ++i) {
        const double gradient = gradient_sum_[i] / std::max(1u, gradient_count_[i]);
        if (gradient > 0) ranked.emplace_back(-gradient, i);
    }
    auto count = static_cast<std::size_t>(std::ceil(request.densify_percent * static_cast<double>(ranked.size())));
    const auto limit = static_cast<std::size_t>(request.max_growth * static_cast<double>(start_count_));
    count = std::min({count, ranked.size(), limit > labelled() ? limit - labelled() : 0});
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < count; ++i)
        if (-ranked[i].first >= request.densify_min_gradient) chosen.push_back(ranked[i].second);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

void WorkingSet::split(std::size_t index, int generation, Random& random) {
    const std::size_t row = first_row_ + index;
    const float* q = &rows_.rotation[row * 4];
    const Mat3 frame = rotation_matrix({q[0], q[1], q[2], q[3]});
    GaussianData child;
    child.sh_degree = rows_.sh_degree;
    child.append_row(rows_, row);
    const GaussianData parent = child;
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
        append(child, 0, generation, -1, ancestor_[index]);
        const std::size_t stride = rows_.sh_stride();
        std::copy_n(birth_sh_.begin() + static_cast<std::ptrdiff_t>(index * stride), stride,
                    birth_sh_.end() - static_cast<std::ptrdiff_t>(stride));
    }
}

std::size_t WorkingSet::keep_added(std::span<const float> weight, std::span<const double> evidence, double tau,
                                   double least_left) {
    GSE_CHECK_EQ(weight.size(), rows_.size());
    std::vector<std::uint8_t> keep(labelled(), 1);
    std::size_t added = 0, dropped = 0;
    for (std::size_t i = 0; i < labelled(); ++i) {
        if (ancestor_[i] >= 0) continue;
        ++added;
        if (evidence[first_row_ + i] <= 0 || weight[first_row_ + i] >= tau) continue;
        keep[i] = 0;
        ++dropped;
    }
    if (dropped == 0 || static_cast<double>(added - dropped) < least_left * static_cast<double>(added)) return 0;
    keep_rows(keep);
    remember_anchor();
    return dropped;
}

DensifyCount WorkingSet::densify(const EditRequest& request, Random& random, bool may_grow) {
    DensifyCount count;
    std::vector<std::size_t> chosen;
    if (may_grow) chosen = densify_candidates(request);
    const int generation = schedule_.advance();
    std::vector<std::uint8_t> keep(labelled(), 1);
    for (const std::size_t index : chosen) {
        const std::size_t row = first_row_ + index;
        const float scale =
            std::max({rows_.log_scale[row * 3], rows_.log_scale[row * 3 + 1], rows_.log_scale[row * 3 + 2]});
        if (std::exp(scale) > request.percent_dense * extent_) {
            split(index, generation, random);
            keep[index] = 0;
            ++count.split;
            continue;
        }
        GaussianData copy;
        copy.sh_degree = rows_.sh_degree;
        copy.append_row(rows_, row);
        append(copy, 0, generation, -1, ancestor_[index]);
        const std::size_t stride = rows_.sh_stride();
        std::copy_n(birth_sh_.begin() + static_cast<std::ptrdiff_t>(index * stride), stride,
                    birth_sh_.end() - static_cast<std::ptrdiff_t>(stride));
        ++count.cloned;
    }
    // Children start without momentum.
    const auto grow = [&](AdamMoments& moments, std::size_t stride) {
        if (moments.first.empty()) return;
        moments.first.resize(labelled() * stride);
        moments.second.resize(labelled() * stride);
    };
    grow(position_, 3);
    grow(log_scale_, 3);
    grow(rotation_, 4);
    grow(opacity_, 1);
    grow(sh_, rows_.sh_stride());
    keep.resize(labelled(), 1);
    for (std::size_t i = 0; i < labelled(); ++i)
        if (keep[i] != 0 && prunable(i, request)) {
            keep[i] = 0;
            ++count.pruned;
        }
    keep_rows(keep);
    std::fill(gradient_sum_.begin(), gradient_sum_.end(), 0.0);
    std::fill(gradient_count_.begin(), gradient_count_.end(), 0u);
    remember_anchor();
    return count;
}

}  // namespace gse::edit
