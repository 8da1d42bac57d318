// What is to be seen of a scene or of a part of it.
#pragma once

#include <span>

#include "engine/math/framing.h"
#include "engine/scene/gaussian_set.h"

namespace gse {

/// The box that shows what matters of the rows with bits[row] != 0 (all if `bits` is empty): visible splats
/// with their extent, floaters and the outermost ones left out. An empty box at the origin where there are
/// none.
Bounds framing_bounds(const GaussianSet& set, std::span<const std::uint8_t> bits = {});

/// Standard deviation along the largest axis of the middle one of some splats, by their log-scales, which are
/// reordered.
double middle_size(std::vector<float>& log_scales);

}  // namespace gse
