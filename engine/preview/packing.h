// Raw parameters of Gaussians -> the arrays the shaders read: activated geometry in float, spherical
// harmonics in half.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/scene/gaussian_set.h"

namespace gse::preview {

/// Texels of four halfs that a row of coefficients takes (3 channels each, padded).
constexpr std::size_t harmonics_texels(int sh_degree) {
    return (static_cast<std::size_t>(sh_coefficient_count(sh_degree)) * 3 + 3) / 4;
}

/// Rows [begin, end) as 12 floats each: position, opacity; unit quaternion; standard deviations, 0. A row
/// that cannot be drawn (a value is NaN, or an infinity without meaning) gets opacity 0.
void pack_geometry(const GaussianSet& set, std::size_t begin, std::size_t end, float* out);

/// Rows [begin, end) as halfs. A row with a coefficient that is not finite begins with NaN, which the shader
/// culls.
void pack_harmonics(const GaussianSet& set, std::size_t begin, std::size_t end, std::uint16_t* out);

/// Nearest half. Beyond the range the largest finite one.
void to_half(const float* in, std::size_t count, std::uint16_t* out);

}  // namespace gse::preview
