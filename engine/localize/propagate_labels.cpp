// Nearest seen neighbours by a k-d tree (nanoflann).
#include "engine/localize/propagate_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/check.h"
#include "engine/localize/row_tree.h"

namespace gse::localize {
namespace {

/// Diagonal of the box around the seen rows above the threshold.
double labelled_diagonal(const RowPoints& seen, const LabelField& field, double threshold) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < seen.row.size(); ++i) {
        if (field.probability[seen.row[i]] <= threshold) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], seen.position[i * 3 + axis]);
            high[axis] = std::max(high[axis], seen.position[i * 3 + axis]);
        }
    }
    if (low[0] > high[0]) return 0;
    return std::hypot(static_cast<double>(high[0]) - low[0], static_cast<double>(high[1]) - low[1],
                      static_cast<double>(high[2]) - low[2]);
}

}  // namespace

LabelField propagate_labels_knn(const GaussianSpans& gaussians, const SpreadParameters& parameters,
                                LabelField field, ThreadPool* threads) {
    GSE_CHECK_EQ(field.probability.size(), gaussians.size);
    field.inferred.assign(gaussians.size, 0);
    RowPoints seen;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (field.coverage[row] <= parameters.least_coverage || !finite_position(gaussians, row)) continue;
        seen.add(gaussians, row);
    }
    const double reach = parameters.reach_share * labelled_diagonal(seen, field, parameters.threshold);
    if (seen.row.empty() || reach <= 0 || parameters.neighbours <= 0) return field;
    seen = along_curve(gaussians, seen);
    const RowTree tree(3, seen, nanoflann::KDTreeSingleIndexAdaptorParams(RowTreeLeaf));
    RowPoints unseen;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (field.coverage[row] > parameters.least_coverage || !finite_position(gaussians, row)) continue;
        unseen.add(gaussians, row);
    }
    unseen = along_curve(gaussians, unseen);
    const auto take = [&](std::size_t point, std::span<const std::uint32_t> nearest,
                          std::span<const float> squared) {
        double opinion = 0, voices = 0;
        for (std::size_t i = 0; i < nearest.size(); ++i) {
            const double distance = std::sqrt(static_cast<double>(squared[i]));
            if (distance > reach) continue;
            const auto other = seen.row[nearest[i]];
            const double voice = field.coverage[other] / (distance + 1e-3 * reach);
            opinion += voice * field.probability[other];
            voices += voice;
        }
        if (voices <= 0) return;
        const auto row = unseen.row[point];
        field.probability[row] = static_cast<float>(std::clamp(opinion / voices, 0.0, 1.0));
        field.inferred[row] = 1;
    };
    constexpr double JustBeyond = 1 + 1e-6;  // distances are squared in single precision
    nearest_of_all(tree, unseen.position, static_cast<std::size_t>(parameters.neighbours), threads, take,
                   JustBeyond * reach);
    return field;
}

}  // namespace gse::localize
