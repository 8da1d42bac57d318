// Camera and scene as the kernels of every fast version take them.
#pragma once

#include "engine/math/camera.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Most tile-Gaussian pairs of one picture. More are refused.
inline constexpr std::size_t MostPairs = 1'000'000'000;

/// Aborts if the arrays' lengths disagree or the camera has no pixels.
void check_inputs(const GaussianSpans& gaussians, const Camera& camera);

/// Floats of spherical harmonics per row.
std::size_t sh_floats(const GaussianSpans& gaussians);

/// `settings` with both planes given (with_depth_range).
Viewpoint viewpoint_of(const Camera& camera, const Settings& settings, int scene_degree);

}  // namespace gse::raster
