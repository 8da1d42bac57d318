// One label for splats that belong together: a minimum cut over neighbouring splats, where a cut costs less
// between unlike colours. It closes the holes and takes off the crumbs that coarse maps leave.
#pragma once

#include <span>

#include "engine/base/thread_pool.h"
#include "engine/localize/back_projection.h"

namespace gse::localize {

struct CutParameters {
    int neighbours = 8;       // nearest rows an edge goes to
    double smoothness = 1.5;  // cost of a cut between two rows of one colour, in nats; 0 = nothing is done
    double tau = 0.5;         // weight at which a row is undecided
    double least_evidence_px = 0.5;
    double margin_share =
        0.1;  // of the diagonal: rows farther than this outside the box of the labelled ones stay out
    int reach =
        3;  // edges from rows that prefer the label to where the first graph ends; 0 = everything at once
    double island_share = 0;  // of the labelled rows: islands of no more take the label; 0 = none does
};

/// Moves the weight of rows to the other side of `tau` so that label_energy() becomes least, exactly (Boykov
/// and Jolly 2001, with the contrast term of GrabCut, on a graph of splats in place of pixels). Rows that
/// neither a view saw nor a neighbour spoke for keep what they have. Then islands take the label, where that
/// is asked for: rows without it that are joined to other rows without it by no pair of mutual neighbours, so
/// that they would hang in the air if the labelled ones were gone. Returns how many rows changed sides. The
/// same for any number of threads (null = one); without OpenCV nothing is done.
std::size_t cut_label(const GaussianSpans& gaussians, const CutParameters& parameters, LabelWeights& weights,
                      ThreadPool* threads = nullptr);

/// E(label) = sum over rows of -log p(label | weight) * trust in the row + smoothness * sum over pairs of
/// neighbours with different labels of exp(-|colour difference|^2 / mean of it), in nats; label [N], the rows
/// that take part count.
double label_energy(const GaussianSpans& gaussians, const CutParameters& parameters,
                    const LabelWeights& weights, std::span<const std::uint8_t> label);

}  // namespace gse::localize
