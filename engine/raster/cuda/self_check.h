// Whether a rasterizer draws and differentiates a small built-in scene as the plain version does: asked of
// every CUDA device before it is used, so that one that computes something else is refused rather than
// believed.
#pragma once

#include <string>

#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Differences to the plain version on the built-in scene. Pixels where rounding may decide a cut otherwise
/// are left out.
struct SelfCheck {
    double image = 0;          // largest over colour, alpha and composited values
    double depth = 0;          // largest, world units
    std::size_t counts = 0;    // pixels with another number of blended Gaussians
    double gradient = 0;       // largest relative L2 over the tensors
    double contributions = 0;  // relative L2
    bool repeats = true;       // a second run gave the same bits

    bool passed() const;
    std::string figures() const;  // all of them with their limits, one line
};

SelfCheck check_against_plain(Rasterizer& rasterizer);

/// Throws Error with the figures where the check fails; `what` is the device's name.
void require_agreement(Rasterizer& rasterizer, const std::string& what);

}  // namespace gse::raster
