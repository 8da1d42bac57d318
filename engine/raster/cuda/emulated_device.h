// The processor in the place of a CUDA device, for tests: the kernels' own source, block by block and thread
// by thread. It shows that the kernels and their launches compute the right thing; it says nothing about
// their speed, nor about what only a device can do wrong.
#pragma once

#include <memory>

#include "engine/raster/cuda/device.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

/// Blocks, and the threads of a phase, in order or the last one first: no result may tell.
enum class EmulationOrder { Forward, Reversed };

/// Fresh and shared memory is filled with ones (NaN), so that what is read before it is written shows.
std::unique_ptr<Device> make_emulated_device(EmulationOrder order = EmulationOrder::Forward);

/// One launch of a kernel (its index in kernel_list.inl) whose arguments point to the processor's memory.
void run_emulated(int kernel, std::uint32_t blocks, const void* arguments);

/// The rasterizer on it, named "emulated cuda".
std::unique_ptr<Rasterizer> make_emulated_cuda_rasterizer(EmulationOrder order = EmulationOrder::Forward);

}  // namespace gse::raster::cuda
