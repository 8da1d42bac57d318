// Loss of a scene format: the written bytes read back and compared, field by field.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/scene/gaussian_set.h"

namespace gse::io {

/// Worst differences of each lossy field in words, separated by commas, with the number of splats that show
/// them. Sizes are those that a near view of the scene draws: its blur hides how thin a flat splat is. Empty
/// when nothing but float rounding differs. Row `order[i]` (i without an order) of `written` became row `i`
/// of `back`.
std::string describe_loss(const GaussianSet& written, const GaussianSet& back,
                          std::span<const std::uint32_t> order);

}  // namespace gse::io
