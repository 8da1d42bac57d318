// Layers of a voxel grid at which one thing stands on another: a flat that reaches out on all sides.
#pragma once

#include <vector>

#include "engine/localize/voxel_grid.h"

namespace gse::localize {

/// Neighbouring layers at which something stands on a support. The support's top lies among them.
struct SupportLayers {
    int first = 0;  // lowest layer with evidence
    int top = 0;    // highest layer with strong evidence
    int last = 0;   // highest layer with evidence
};

/// Supports of the members of `set`, from below upwards. A layer is evidence where a flat reaches out beyond
/// the cross-section above it, in most of 16 directions. It is strong where the flat reaches out nearly
/// everywhere, or has another colour than what stands there.
std::vector<SupportLayers> support_layers(const VoxelGrid& grid, const VoxelSet& set);

/// Cross-section of what stands above layer `z`: columns of the six layers over it, with what they enclose.
Mask section_above(const VoxelGrid& grid, const VoxelSet& set, int z);

/// The members without those of the support, decided between the layers `low` and `high` by colour, place and
/// neighbours. `upper` = false: those of the support instead.
VoxelSet split_at(const VoxelGrid& grid, const VoxelSet& set, int low, int high, bool upper);

/// Layers where the members hang together by a thread: a cross-section below an eighth of those on both
/// sides, between different colours.
std::vector<int> thin_layers(const VoxelGrid& grid, const VoxelSet& set);

}  // namespace gse::localize
