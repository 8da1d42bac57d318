// Noise that lies on the scene's surface (METHOD.md, Noise on the surface). Views of one place get one noise,
// so that a model redraws them alike.
#pragma once

#include <cstdint>
#include <span>

#include "engine/base/image.h"
#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// Standard normal noise [cells,cells,channels] for a view. Every pixel's surface point falls into a voxel of
/// world side `voxel` that has normals of its own. A cell's noise is sum c n / sqrt(sum c^2) over its voxels
/// with c pixels each. It has unit variance and is equal wherever equal voxels are seen. Pixels without a
/// surface have noise of this `view` alone.
Image surface_noise(const Image& depth, const Camera& camera, int cells, int channels, double voxel,
                    std::uint64_t seed, std::uint64_t view);

/// Half the world size of a cell at the median depth of the masks' pixels. 1 if they show nothing.
double noise_voxel(std::span<const EditView> views, int cells);

}  // namespace gse::edit
