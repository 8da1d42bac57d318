// Part of a thing around a point on it, by minimum cuts of several sizes.
#pragma once

#include "engine/localize/voxel_grid.h"

namespace gse::localize {

/// Members of `thing` that are the part around the voxel at `seed` (METHOD.md, Things from a click). It is
/// the smallest with a clear border that hardly grows with the size that is looked for. Empty where no border
/// is clear, for things of a few voxels, and without OpenCV.
VoxelSet linked_part(const VoxelGrid& grid, const VoxelSet& thing, const VoxelGrid::Place& seed);

}  // namespace gse::localize
