// Real spherical harmonics in the 3DGS basis order and signs, degrees 0-3.
#pragma once

namespace gse {

inline constexpr double ShC0 = 0.28209479177387814;
inline constexpr int MaxShDegree = 3;

/// Number of coefficients per channel, DC included: 1, 4, 9, 16.
constexpr int sh_coefficient_count(int degree) { return (degree + 1) * (degree + 1); }

/// DC coefficient of a base colour and back: colour = 0.5 + ShC0 * f_dc.
constexpr double sh_from_colour(double colour) { return (colour - 0.5) / ShC0; }
constexpr double colour_from_sh(double f_dc) { return 0.5 + ShC0 * f_dc; }

}  // namespace gse
