// The grid on the processor: the threads of a phase one after the other, in an order that tests may reverse.
// It shows the kernels' results, not their speed.
#pragma once

#define GSE_DEVICE static inline
#define GSE_MEMBER

namespace gse::raster::cuda {

/// The block that runs.
struct Grid {
    std::uint32_t block;
    void* shared;   // SharedBytes, of unknown content
    bool reversed;  // the last thread first
    std::uint32_t at(std::uint32_t index, std::uint32_t count) const {
        return reversed ? count - 1 - index : index;
    }
};

// Shared memory that every CUDA device has without being asked for more.
inline constexpr std::size_t SharedBytes = 48 * 1024;

/// One value of each thread of the block.
template <class T> struct PerThread {
    T all[BlockThreads];
    T& operator[](std::uint32_t t) { return all[t]; }
    const T& operator[](std::uint32_t t) const { return all[t]; }
};
template <class T> struct PerLane {
    T all[WarpLanes];
    T& operator[](std::uint32_t lane) { return all[lane]; }
    const T& operator[](std::uint32_t lane) const { return all[lane]; }
};

#define GSE_EACH(grid, i, count)                                                  \
    for (std::uint32_t i##_next = 0, i = (grid).at(0, count); i##_next < (count); \
         ++i##_next, i = (grid).at(i##_next, count))
#define GSE_THREADS(grid, t) GSE_EACH(grid, t, BlockThreads)
#define GSE_WARPS(grid, w) GSE_EACH(grid, w, BlockWarps)
#define GSE_LANES(grid, lane) GSE_EACH(grid, lane, WarpLanes)
#define GSE_SHARED(grid, Type, name)            \
    static_assert(sizeof(Type) <= SharedBytes); \
    Type& name = *static_cast<Type*>((grid).shared)

/// True when any thread of the block says so.
GSE_DEVICE bool any_thread(const Grid&, const PerThread<bool>& says) {
    bool result = false;
    for (const bool one : says.all) result = result || one;
    return result;
}
/// True when any thread of a warp says so.
GSE_DEVICE bool any_lane(const PerLane<bool>& says) {
    bool result = false;
    for (const bool one : says.all) result = result || one;
    return result;
}

/// Sum over the warp's lanes, in every lane, in the order of a butterfly.
GSE_DEVICE void sum_lanes(PerLane<float>& value) {
    for (std::uint32_t distance = WarpLanes / 2; distance > 0; distance /= 2) {
        PerLane<float> next;
        for (std::uint32_t lane = 0; lane < WarpLanes; ++lane)
            next.all[lane] = value.all[lane] + value.all[lane ^ distance];
        value = next;
    }
}

/// Counts. Sums of whole numbers do not depend on the order.
GSE_DEVICE void add_atomically(std::uint32_t* to, std::uint32_t value) { *to += value; }

/// Fused a b + c, rounded once as on a device.
GSE_DEVICE float fused(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
GSE_DEVICE double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
/// 2^a; results below 2^-126 are 0.
GSE_DEVICE float power_of_two(float a) { return a > -126.0f ? __builtin_exp2f(a) : 0.0f; }

}  // namespace gse::raster::cuda
