// Sets of Gaussians one behind the other.
#pragma once

#include <span>

#include "engine/scene/gaussian_set.h"

namespace gse {

/// All rows in the order of the parts, at the highest SH degree among them. Colours of a lower degree go on
/// with zeros. One part is shared as it is. Throws OutOfMemory.
GaussianSet joined(std::span<const GaussianSet> parts);

}  // namespace gse
