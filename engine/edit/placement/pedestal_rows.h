// Pedestal under an object whose label takes in its upper part (METHOD.md, Pedestal under a thing).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Rows [N] of the pedestal below the figure that `bits` [N] label, 0 or 1; empty = none was found. A
/// pedestal is an upright prism or column that stands below the figure. Its cross-section stays constant down
/// to its base, its walls are closed on all sides, and its face is clearly wider than the figure right above.
///
/// Only for labels of figures: the lower half of a car is such a prism, too.
std::vector<std::uint8_t> pedestal_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                        const Vec3& up, const Vec3& front);

}  // namespace gse::edit
