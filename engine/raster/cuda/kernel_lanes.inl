// One lane per thread. Register types and image formation are those of the vector kernels, with W = 1.

/// Functions for exp_lanes and log2_lanes of kernel_geometry.inl. A device has no library for them.
#define GSE_ONE_LANE_MATH 1
#include "engine/raster/simd_scalar.h"

/// a 2^power, for whole powers and results that are normal numbers.
GSE_INLINE F scale_by_power(F a, F power) {
    const std::int32_t field = static_cast<std::int32_t>(power.v) * (1 << 23);
    return {__builtin_bit_cast(float, __builtin_bit_cast(std::int32_t, a.v) + field)};
}
GSE_INLINE F exponent_of(F a) {
    return {static_cast<float>((__builtin_bit_cast(std::int32_t, a.v) >> 23) - 127)};
}
GSE_INLINE F mantissa_of(F a) {
    return {__builtin_bit_cast(float, (__builtin_bit_cast(std::int32_t, a.v) & 0x007fffff) | 0x3f800000)};
}

// clang-format off
#include "engine/raster/kernel_geometry.inl"
#include "engine/raster/kernel_project.inl"
#include "engine/raster/kernel_blend.inl"
#include "engine/raster/kernel_backward.inl"
#include "engine/raster/kernel_gradient.inl"
// clang-format on
