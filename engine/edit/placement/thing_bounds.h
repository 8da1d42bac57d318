// Bounds of what stands on a scene's ground, for the camera's home.
#pragma once

#include "engine/math/framing.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Box of what rises from the ground, world units. That of the whole scene (framing_bounds()) where nothing
/// does, where there is no ground, or where it is no wider than what stands on it. `up`: unit vector.
Bounds thing_bounds(const GaussianSet& set, const Vec3& up);

}  // namespace gse::edit
