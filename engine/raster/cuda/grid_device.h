// The grid of a CUDA device, by the compiler's own names. No toolkit's headers are read.
#pragma once

#define GSE_DEVICE static inline __attribute__((device, always_inline))
#define GSE_MEMBER __attribute__((device, always_inline))

namespace gse::raster::cuda {

/// The block that runs.
struct Grid {
    std::uint32_t block;
};

constexpr std::uint32_t WholeWarp = 0xffffffff;

GSE_DEVICE std::uint32_t own_thread() { return static_cast<std::uint32_t>(__nvvm_read_ptx_sreg_tid_x()); }
GSE_DEVICE void end_phase() { __nvvm_bar_sync(0); }
GSE_DEVICE void end_warp_phase() { __nvvm_bar_warp_sync(WholeWarp); }

/// A register of each thread of the block.
template <class T> struct PerThread {
    T own;
    __attribute__((device)) T& operator[](std::uint32_t) { return own; }
    __attribute__((device)) const T& operator[](std::uint32_t) const { return own; }
};
template <class T> using PerLane = PerThread<T>;

#define GSE_THREADS(grid, t) \
    for (std::uint32_t t = own_thread(), t##_left = 1; t##_left != 0; t##_left = 0, end_phase())
#define GSE_WARPS(grid, w) \
    for (std::uint32_t w = own_thread() / WarpLanes, w##_left = 1; w##_left != 0; w##_left = 0, end_phase())
#define GSE_LANES(grid, lane)                                                              \
    for (std::uint32_t lane = own_thread() % WarpLanes, lane##_left = 1; lane##_left != 0; \
         lane##_left = 0, end_warp_phase())
#define GSE_SHARED(grid, Type, name) static __attribute__((shared)) Type name

/// True when any thread of the block says so. For the whole block.
GSE_DEVICE bool any_thread(const Grid&, const PerThread<bool>& says) {
    return __nvvm_bar0_or(says.own ? 1 : 0) != 0;
}
/// True when any thread of a warp says so. For the whole warp.
GSE_DEVICE bool any_lane(const PerLane<bool>& says) { return __nvvm_vote_any_sync(WholeWarp, says.own); }

/// Sum over the warp's lanes, in every lane, in the order of a butterfly.
GSE_DEVICE void sum_lanes(PerLane<float>& value) {
#pragma unroll
    for (int distance = WarpLanes / 2; distance > 0; distance /= 2)
        value.own += __nvvm_shfl_sync_bfly_f32(WholeWarp, value.own, distance, WarpLanes - 1);
}

/// Atomic counts. Sums of whole numbers do not depend on the order.
GSE_DEVICE void add_atomically(std::uint32_t* to, std::uint32_t value) {
    __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
}

/// Fused a b + c, rounded once.
GSE_DEVICE float fused(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
GSE_DEVICE double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
/// 2^a, relative error below 2^-22 (PTX ISA, ex2.approx); results below 2^-126 are 0.
GSE_DEVICE float power_of_two(float a) {
    float result;
    asm("ex2.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(a));
    return result;
}

}  // namespace gse::raster::cuda
