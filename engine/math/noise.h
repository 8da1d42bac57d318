// Smooth noise in space, and mixing functions for procedural textures.
#pragma once

#include "engine/math/vec.h"

namespace gse {

/// Smooth noise in [0,1] with features of about one unit. Depends on the point alone.
double value_noise(const Vec3& p);
/// Three octaves of value_noise, in [0,1].
double layered_noise(const Vec3& p);

/// Linear mix: a at t = 0, b at t = 1.
Vec3 mix(const Vec3& a, const Vec3& b, double t);
/// Smooth step 3 t^2 - 2 t^3: 0 below `low`, 1 above `high`.
double smooth_step(double low, double high, double x);

}  // namespace gse
