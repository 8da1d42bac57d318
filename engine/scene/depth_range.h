// Near plane of pictures, for scenes of any size.
#pragma once

#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse {

/// Near plane in depth along the view: splats nearer than it are left out. It is a tenth of the depth of the
/// nearest visible splats in the picture, one in fifty of them aside. It scales with the scene, follows the
/// camera, and never hides everything. 0 = nothing lies in front of the camera. A fixed sample of the rows
/// decides.
double fitted_near_plane(const GaussianSpans& gaussians, const Camera& camera);

}  // namespace gse
