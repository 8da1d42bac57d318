// Times an iteration of an edit with and without the skips of a view session, and checks that they change
// nothing.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/math/camera.h"
#include "engine/raster/bench.h"
#include "engine/scene/gaussian_set.h"

namespace gse::raster {

/// Milliseconds of processor time per view, all threads together: medians over the repetitions.
struct SkipTimes {
    double forward_ms = 0, backward_ms = 0;
};

/// One share of the rows that may change.
struct SkipBench {
    double share = 0;
    std::size_t labelled = 0;  // rows
    SkipTimes full, skipping;
    double ratio = 0;       // forward and backward, skipping over full: median of the rounds' ratios
    double prepare_ms = 0;  // the first picture of a view, which prepares it
    double kept_mib = 0;    // per view
    std::size_t full_pairs = 0, pairs = 0;  // tile-Gaussian pairs per view (mean), without and with the skips
    // Largest over the last round's views.
    double picture_difference = 0;   // absolute, of colour, alpha and depth
    double gradient_difference = 0;  // relative L2 over the tensors
};

/// Labels the rows nearest to the row in the middle of the scene, since the labelled rows of an edit lie
/// together. They move a little from round to round.
std::vector<SkipBench> bench_skips(const GaussianSpans& gaussians, std::span<const Camera> cameras,
                                   const BenchSettings& settings, std::span<const double> shares);

}  // namespace gse::raster
