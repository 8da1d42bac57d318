// Labels for splats that no view sees (undersides, insides). They take the opinion of the nearest splats that
// are seen.
#pragma once

#include "engine/base/thread_pool.h"
#include "engine/localize/back_projection.h"

namespace gse::localize {

struct SpreadParameters {
    int neighbours = 8;           // seen rows that are asked
    double least_coverage = 0.5;  // pixels: rows with no more are unseen
    // Share of the diagonal of the clearly labelled rows: no opinion is taken from farther away.
    double reach_share = 0.15;
    double threshold = 0.5;  // probability above which a row counts as labelled
};

/// Field in which every unseen row has the mean probability of its nearest seen neighbours, by coverage over
/// distance. Marks it in `inferred`. Rows out of reach, or with a position that is not finite, keep theirs.
/// Independent of the number of threads (null = one); O(N log N).
LabelField propagate_labels_knn(const GaussianSpans& gaussians, const SpreadParameters& parameters,
                                LabelField field, ThreadPool* threads = nullptr);

}  // namespace gse::localize
