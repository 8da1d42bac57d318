// Bounds of a scene, or of a part of it, for pictures of it.
#pragma once

#include <span>

#include "engine/math/framing.h"
#include "engine/scene/gaussian_set.h"

namespace gse {

/// Box of the rows with bits[row] != 0 (all if `bits` is empty): visible splats with their extent. Floaters
/// and outermost splats are left out, and haze and sky far around where all rows are asked for. An empty box
/// at the origin if there are none.
Bounds framing_bounds(const GaussianSet& set, std::span<const std::uint8_t> bits = {});

/// Median over some splats of the standard deviation along the largest axis. `log_scales` are reordered.
double middle_size(std::vector<float>& log_scales);

}  // namespace gse
