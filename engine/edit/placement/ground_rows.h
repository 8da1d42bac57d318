// Ground under an object that its masks took for the object (METHOD.md, Ground under a thing).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Rows of the label `bits` [N] that are ground, ascending. They lie at the height of the ground that the
/// object stands on. Their colour (SH degree 0) is at most half as far from the ground around as from the
/// higher part of the object.
///
/// Masks of few pixels close over the gap between two legs, and unseen rows below an object go with it. None
/// if no ground reaches out on all sides, or if most of the label is that low: a ground is an object, too.
std::vector<std::size_t> ground_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                     const Vec3& up, const Vec3& front);

/// Ground among the rows that `bits` [N] label around a ground. Its rows rise by no more than a twentieth of
/// its width above the lowest ones around. [N], all labelled rows if they are no wider than high.
std::vector<std::uint8_t> lowest_layer(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                       const Vec3& up);

}  // namespace gse::edit
