// Smooth noise in space, and what procedural textures are mixed with.
#pragma once

#include "engine/math/vec.h"

namespace gse {

/// Smooth noise in [0,1] with features of about one unit; the same everywhere for the same point.
double value_noise(const Vec3& p);
/// Three octaves of value_noise, in [0,1].
double layered_noise(const Vec3& p);

/// a where t is 0, b where it is 1.
Vec3 mix(const Vec3& a, const Vec3& b, double t);
/// 0 below `low`, 1 above `high`, smooth between (3 t^2 - 2 t^3).
double smooth_step(double low, double high, double x);

}  // namespace gse
