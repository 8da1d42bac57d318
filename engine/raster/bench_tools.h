// What the rasterizer's benches share: a picture's gradient, a difference.
#pragma once

#include <span>

#include "engine/base/image.h"

namespace gse::raster {

/// A gradient image like a loss would send: noise of unit size.
Image noise_image(int width, int height);

/// |found - expected| / |expected|, both as Euclidean lengths; not divided where nothing is expected.
double relative_error(std::span<const float> found, std::span<const float> expected);

}  // namespace gse::raster
