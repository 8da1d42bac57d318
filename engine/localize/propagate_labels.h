// Labels for splats that no view sees (undersides, insides). They take the opinion of the nearest splats that
// are seen.
#pragma once

#include "engine/base/thread_pool.h"
#include "engine/localize/back_projection.h"

namespace gse::localize {

struct SpreadParameters {
    int neighbours = 8;              // seen rows that are asked
    double least_evidence_px = 0.5;  // rows with no more than this are unseen
    double reach_share =
        0.15;          // of the diagonal of the clearly labelled rows: no opinion is taken from farther away
    double tau = 0.5;  // what counts as labelled
};

/// Sets the weight of every unseen row to the mean weight of its nearest seen neighbours, by evidence over
/// distance. Marks it in `inferred`. Rows out of reach, or with a position that is not finite, keep theirs.
/// Independent of the number of threads (null = one); O(N log N).
void propagate_labels_knn(const GaussianSpans& gaussians, const SpreadParameters& parameters,
                          LabelWeights& weights, ThreadPool* threads = nullptr);

}  // namespace gse::localize
