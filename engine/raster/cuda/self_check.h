// Comparison of a rasterizer with the plain version on a small built-in scene, drawing and derivative. Every
// CUDA device must pass before use, so that one with other results is refused.
#pragma once

#include <string>

#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Differences to the plain version on the built-in scene. Pixels whose cut may depend on rounding are left
/// out.
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

/// Throws Error with the figures if the check fails. `what` is the device's name.
void require_agreement(Rasterizer& rasterizer, const std::string& what);

}  // namespace gse::raster
