// Where a thing may be that takes the place of another, or is new: the space that hulls are carved out of
// (views.md 17).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/placement/visual_hull.h"
#include "engine/edit/placement/voxel_region.h"

namespace gse::edit {

/// Room for a thing in the place of the labelled one, the same from every side, as it is not known which way
/// the new one faces: an upright cylinder that stands where what `bits` [N] label stands (standing_of()),
/// `share` of its size wider and higher; what was low may be followed by something higher (figure_height()),
/// what was thin by something wider. Empty when nothing is left.
VoxelRegion room_around(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up,
                        const Vec3& front, double share);

/// The same for what is added to a thing: higher by a share of its longest side, as a crown on a low thing
/// is.
VoxelRegion room_above(const UprightBounds& thing, const Vec3& up, const Vec3& front, double share);

/// Bounds of a room with a cell more on every side; without a room, of the rows of `place`, grown.
HullBox bounds_of(const VoxelRegion& room, const GaussianData& place);

}  // namespace gse::edit
