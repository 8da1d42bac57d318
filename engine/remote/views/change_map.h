// Differences of a redrawn picture from the scene, and the outline of something new in it.
#pragma once

#include "engine/base/image.h"

namespace gse::remote {

/// Largest difference of a pixel's channels, [H,W,1], blurred over `blur_px`.
Image change_map(const Image& before, const Image& after, double blur_px);

/// Coverage [H,W,1] in [0,1] of what is new inside `mask`: changes above Otsu's threshold of those inside.
/// All zero where no change stands out.
Image outline_of_change(const Image& change, const Mask& mask);

}  // namespace gse::remote
