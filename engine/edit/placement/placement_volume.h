// Space of an object that replaces another, or is new; hulls are carved out of it (METHOD.md, Where something
// new goes).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/placement/visual_hull.h"
#include "engine/edit/placement/voxel_region.h"

namespace gse::edit {

/// Room for an object in the place of the labelled one, equal from every side, since its front is not known
/// yet. It is an upright cylinder on the place of the labelled rows (`bits` [N], standing_of()), `share` of
/// its size wider and higher. A low object may be followed by a higher one (figure_height()), a thin one by a
/// wider one. Empty when nothing is left.
VoxelRegion room_around(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up,
                        const Vec3& front, double share);

/// Room for something added to an object. It is higher by a share of its longest side, as a crown on a low
/// object is.
VoxelRegion room_above(const UprightBounds& thing, const Vec3& up, const Vec3& front, double share);

/// Bounds of a room with a cell more on every side. Without a room, grown bounds of the rows of `place`.
HullBox bounds_of(const VoxelRegion& room, const GaussianData& place);

}  // namespace gse::edit
