// Label borders that the edges of the pictures make: the thing goes on there, and hardly a view shows it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/thread_pool.h"
#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::localize {

struct FrameCutParameters {
    int neighbours = 8;          // nearest Gaussians among which a labelled one has its border
    double outside_share = 0.5;  // of the pictures; a Gaussian outside of more lies beyond their edges
};

/// Border of a label: pairs of a labelled Gaussian and a near one that is not labelled.
struct FrameCut {
    std::size_t border = 0;
    std::size_t beyond = 0;  // pairs whose unlabelled Gaussian lies beyond the pictures' edges
    double share() const {
        return border > 0 ? static_cast<double>(beyond) / static_cast<double>(border) : 0;
    }
};

/// Counts the border of the rows with bits[row] != 0, as seen by the cameras. Gaussians too faint to be seen
/// do not count. No border without a camera.
FrameCut frame_cut(const GaussianSpans& gaussians, std::span<const std::uint8_t> bits,
                   std::span<const Camera> cameras, const FrameCutParameters& parameters = {},
                   ThreadPool* threads = nullptr);

}  // namespace gse::localize
