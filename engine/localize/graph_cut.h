// One label for splats that belong together: a minimum cut over neighbouring splats. A cut costs less between
// unlike colours. It closes holes and removes the crumbs of coarse maps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/localize/back_projection.h"

namespace gse::localize {

struct CutParameters {
    int neighbours = 8;       // nearest rows an edge goes to
    double smoothness = 1.5;  // cost of a cut between two rows of one colour, in nats; 0 = nothing is done
    double threshold = 0.5;   // probability at which a row is undecided
    double least_coverage = 0.5;  // pixels: rows with no more are unseen
    // Share of the diagonal: rows farther than this outside the box of the labelled ones stay out.
    double margin_share = 0.1;
    // Edges from rows that prefer the label to where the first graph ends; 0 = everything at once.
    int reach = 3;
    double island_share = 0;  // of the labelled rows: islands of no more take the label; 0 = none does
};

/// Label [N] of the least label_energy(), exactly. The graph cut is that of Boykov and Jolly (2001) with the
/// contrast term of GrabCut, on splats in place of pixels. Rows with no vote of a view or a neighbour, and
/// those far from the label, are as bits() has them.
///
/// Then islands take the label, if asked for. An island is a group of rows without it that no pair of mutual
/// neighbours joins to other such rows. It would hang in the air without the labelled rows.
///
/// Independent of the number of threads (null = one). Equal to bits() without OpenCV.
std::vector<std::uint8_t> cut_label(const GaussianSpans& gaussians, const CutParameters& parameters,
                                    const LabelField& field, ThreadPool* threads = nullptr);

/// Probability on the label's side of the threshold: itself, or a little beyond the threshold.
float decided_probability(float probability, bool labelled, double threshold);

/// Energy of a label [N], in nats, over the rows that take part:
///
///   E(label) = sum over rows of -log p(label | probability) * trust
///              + smoothness * sum over pairs of neighbours with different labels of exp(-d^2 / mean d^2)
///
/// d is the colour difference of a pair.
double label_energy(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelField& field,
                    std::span<const std::uint8_t> label);

}  // namespace gse::localize
