// Arithmetic that the scene formats share: 8-bit opacities, quaternions, SH under axis flips, clamped
// quantisation.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::io {

/// Margin that opacities of exactly 0 or 1 are pulled in by, so that their logits are finite (+-13.8).
inline constexpr double OpacityMargin = 1e-6;
/// Log-scale of an axis that a format stores as exactly flat: e^-23 = 1e-10 units.
inline constexpr float FlattestLogScale = -23.025851f;

/// Logit of a linear opacity, clamped to be finite.
float logit_from_opacity(double opacity);
/// The 256 logits of 8-bit opacities.
const std::array<float, 256>& byte_logits();

double opacity_from_logit(double logit);

/// round(value) clamped to 0..255. NaN gives 0.
inline std::uint8_t to_byte(double value) {
    if (!(value > 0)) return 0;
    return value >= 255 ? 255 : static_cast<std::uint8_t>(value + 0.5);
}

/// q / |q|. A zero or non-finite quaternion gives (1,0,0,0).
std::array<double, 4> unit_quaternion(const float* wxyz);

/// Signs of a flip of world axes. Each is +1 or -1.
struct AxisSigns {
    int x = 1, y = 1, z = 1;
    bool identity() const { return x == 1 && y == 1 && z == 1; }
};

/// Mirrors or rotates everything by the flip: positions, rotations and every SH band.
void flip_axes(GaussianData& data, const AxisSigns& signs);

/// SH degree with `rest` coefficients per channel beyond DC (0, 3, 8, 15), or -1.
int degree_of_rest(std::size_t rest);
/// Coefficients per channel beyond DC.
constexpr std::size_t rest_of_degree(int degree) {
    return static_cast<std::size_t>(sh_coefficient_count(degree)) - 1;
}

/// Rows that a quantised format can hold: the usable ones. Logs a warning when some are left out.
GaussianSet storable_rows(const GaussianSet& set, const char* format);

/// Appends the bytes of a trivially copyable value.
template <class T> void append_value(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace gse::io
