// Tools of the rasterizer's benches: a picture's gradient, a difference.
#pragma once

#include <span>

#include "engine/base/image.h"

namespace gse::raster {

/// A gradient image like that of a loss: noise of unit size.
Image noise_image(int width, int height);

/// Relative difference |found - expected| / |expected| of Euclidean lengths. Not divided if `expected` is
/// zero.
double relative_error(std::span<const float> found, std::span<const float> expected);

}  // namespace gse::raster
