// One lane per thread: the register types and the image formation are those of the vector kernels, with W = 1.

/// For exp_lanes and log2_lanes of kernel_geometry.inl: no library is there for a device.
#define GSE_ONE_LANE_MATH 1
#include "engine/raster/simd_scalar.h"

GSE_INLINE D round_nearest(D a) { return {__builtin_rint(a.v)}; }
/// a 2^power for whole powers in [-1022, 1023].
GSE_INLINE D scale_by_power(D a, D power) {
    return {a.v * __builtin_bit_cast(double, static_cast<std::int64_t>(static_cast<std::int32_t>(power.v) + 1023) << 52)};
}
GSE_INLINE D exponent_of(D a) {
    return {static_cast<double>(static_cast<std::int32_t>(__builtin_bit_cast(std::int64_t, a.v) >> 52) - 1023)};
}
GSE_INLINE D mantissa_of(D a) {
    return {__builtin_bit_cast(double, (__builtin_bit_cast(std::int64_t, a.v) & 0xfffffffffffffll) | 0x3ff0000000000000ll)};
}

// clang-format off
#include "engine/raster/kernel_geometry.inl"
#include "engine/raster/kernel_project.inl"
#include "engine/raster/kernel_blend.inl"
#include "engine/raster/kernel_backward.inl"
#include "engine/raster/kernel_gradient.inl"
// clang-format on
