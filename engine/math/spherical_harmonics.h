// Real spherical harmonics of the 3DGS basis (degrees 0-3) and their derivatives, in double precision.
#pragma once

#include "engine/math/sh.h"
#include "engine/math/vec.h"

namespace gse {

inline constexpr int MaxShCoefficients = 16;

/// Basis values of a unit direction. Writes sh_coefficient_count(degree) numbers.
void sh_basis(const Vec3& direction, int degree, double* basis);

/// Derivative of each basis value with respect to the direction's components, taken as independent variables.
void sh_basis_gradient(const Vec3& direction, int degree, Vec3* gradient);

}  // namespace gse
