// The interface between a kernel and its machine, in one form for a CUDA device and one for the processor.
// The kernels are one source.
//
// A kernel is a body that the whole block runs, made of phases. GSE_THREADS(grid, t) { ... } is run by every
// thread t of the block before any of them goes on. It always ends with a barrier, so none can be forgotten.
// Shared memory is only touched inside phases. Within one phase no thread reads what another one writes. The
// choice of the next phase is equal for the whole block (arguments, or any_thread).
//
// A PerThread holds a thread's value from one phase to the next. GSE_WARPS / GSE_LANES are the counterparts
// for the 32 threads that step together. `continue` leaves a phase; `break` and `return` must not.
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
