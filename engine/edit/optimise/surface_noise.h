// Noise that lies on the scene's surface: views of the same place get the same noise, so that a model redraws
// them alike (views.md 9.1).
#pragma once

#include <cstdint>
#include <span>

#include "engine/base/image.h"
#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// [cells,cells,channels] standard normal noise for a view. Every pixel's surface point falls into a voxel of
/// world side `voxel` that has normals of its own; a cell's noise is sum c n / sqrt(sum c^2) over its voxels
/// with c pixels each, which has unit variance and is the same wherever the same voxels are seen. Pixels
/// without a surface have noise of this `view` alone.
Image surface_noise(const Image& depth, const Camera& camera, int cells, int channels, double voxel,
                    std::uint64_t seed, std::uint64_t view);

/// Half the world size of a cell at the median depth of what the masks show; 1 where they show nothing.
double noise_voxel(std::span<const EditView> views, int cells);

}  // namespace gse::edit
