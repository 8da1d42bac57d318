// Nearest seen neighbours by a k-d tree (nanoflann).
#include "engine/localize/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include "engine/base/check.h"

namespace gse::localize {
namespace {

/// The seen rows as nanoflann wants them.
struct SeenRows {
    std::vector<float> position;          // [M,3]
    std::vector<std::uint32_t> row;       // [M]

    std::size_t kdtree_get_point_count() const { return row.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const { return position[index * 3 + axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, SeenRows>, SeenRows, 3, std::uint32_t>;

bool finite_position(const GaussianSpans& gaussians, std::size_t row) {
    return std::isfinite(gaussians.position[row * 3]) && std::isfinite(gaussians.position[row * 3 + 1]) &&
           std::isfinite(gaussians.position[row * 3 + 2]);
}

/// Diagonal of the box around the seen rows above tau.
double labelled_diagonal(const SeenRows& seen, const LabelWeights& weights, double tau) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < seen.row.size(); ++i) {
        if (weights.weight[seen.row[i]] <= tau) continue;
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

void spread_to_unseen(const GaussianSpans& gaussians, const SpreadParameters& parameters, LabelWeights& weights) {
    GSE_CHECK_EQ(weights.weight.size(), gaussians.size);
    weights.inferred.assign(gaussians.size, 0);
    SeenRows seen;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (weights.evidence[row] <= parameters.least_evidence_px || !finite_position(gaussians, row)) continue;
        seen.row.push_back(static_cast<std::uint32_t>(row));
        for (std::size_t axis = 0; axis < 3; ++axis) seen.position.push_back(gaussians.position[row * 3 + axis]);
    }
    const double reach = parameters.reach_share * labelled_diagonal(seen, weights, parameters.tau);
    if (seen.row.empty() || reach <= 0 || parameters.neighbours <= 0) return;
    constexpr std::size_t leaf_rows = 16;
    const Tree tree(3, seen, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_rows));
    const auto wanted = static_cast<std::size_t>(parameters.neighbours);
    std::vector<std::uint32_t> nearest(wanted);
    std::vector<float> squared(wanted);
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (weights.evidence[row] > parameters.least_evidence_px || !finite_position(gaussians, row)) continue;
        const auto found = tree.knnSearch(&gaussians.position[row * 3], wanted, nearest.data(), squared.data());
        double opinion = 0, voices = 0;
        for (std::size_t i = 0; i < found; ++i) {
            const double distance = std::sqrt(static_cast<double>(squared[i]));
            if (distance > reach) continue;
            const auto other = seen.row[nearest[i]];
            const double voice = weights.evidence[other] / (distance + 1e-3 * reach);
            opinion += voice * weights.weight[other];
            voices += voice;
        }
        if (voices <= 0) continue;
        weights.weight[row] = static_cast<float>(std::clamp(opinion / voices, 0.0, 1.0));
        weights.inferred[row] = 1;
    }
}

}  // namespace gse::localize
