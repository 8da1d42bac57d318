// The little that a kernel needs of the machine it runs on: one form for a CUDA device, one for the
// processor, so that the kernels are one source.
//
// A kernel is a body that the whole block runs, made of phases. GSE_THREADS(grid, t) { ... } is what every
// thread t of the block does before any of them goes on: it ends with a barrier, always, so none can be
// forgotten. Shared memory is only touched inside phases, and within one phase no thread reads what another
// one writes; what decides which phase comes next is the same for the whole block (arguments, or any_thread).
// What a thread keeps from one phase to the next is a PerThread. GSE_WARPS / GSE_LANES are the same for the
// 32 threads that step together. `continue` leaves a phase; `break` and `return` must not.
#pragma once

#include "engine/raster/cuda/arguments.h"

namespace gse::raster::cuda {

inline constexpr std::uint32_t WarpLanes = 32;
inline constexpr std::uint32_t BlockWarps = BlockThreads / WarpLanes;

}  // namespace gse::raster::cuda

#ifdef __CUDA__
#include "engine/raster/cuda/grid_device.h"
#else
#include "engine/raster/cuda/grid_emulated.h"
#endif
