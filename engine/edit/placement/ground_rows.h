// Ground under a thing that its masks took for the thing.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Rows of the label `bits` [N] that are ground, ascending: they lie at the height of the ground that the
/// labelled thing stands on, and in colour (of SH degree 0) are at most half as far from the ground around it
/// as from what of the thing is higher. Masks of few pixels close over the gap between two legs, and what
/// nobody sees below a thing goes with it. None where no ground reaches out on all sides, or where most of
/// the label is that low: a ground is a thing, too.
std::vector<std::size_t> ground_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                     const Vec3& up, const Vec3& front);

/// Of the rows that `bits` [N] label around a ground, the ground: those that rise by no more than a twentieth
/// of its width above the lowest around them. [N], all that is labelled where that is no wider than it is
/// high.
std::vector<std::uint8_t> lowest_layer(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                       const Vec3& up);

}  // namespace gse::edit
