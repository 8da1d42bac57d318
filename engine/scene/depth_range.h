// How near to the camera splats are drawn, for scenes of any size.
#pragma once

#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse {

/// Depth along the view up to which splats are left out: a tenth of the depth of the nearest visible splats
/// in the picture, one in fifty of them aside. It grows and shrinks with the scene, follows the camera, and
/// is never behind all of what is to be seen. 0 = nothing lies in front of the camera. A sample of the rows
/// decides, always the same one.
double fitted_near_plane(const GaussianSpans& gaussians, const Camera& camera);

}  // namespace gse
