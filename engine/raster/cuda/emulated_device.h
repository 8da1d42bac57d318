// The processor in the place of a CUDA device, for tests. It runs the kernels' own source, block by block and
// thread by thread. It shows that kernels and launches compute the right numbers. It says nothing about
// speed, nor about errors that only a device can make.
#pragma once

#include <memory>

#include "engine/raster/cuda/device.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

/// Order of the blocks, and of the threads of a phase: forward or backward. No result may depend on it.
enum class EmulationOrder { Forward, Reversed };

/// Fresh and shared memory is filled with ones (NaN), so that a read before the first write shows.
std::unique_ptr<Device> make_emulated_device(EmulationOrder order = EmulationOrder::Forward);

/// One launch of a kernel (its index in kernel_list.inl). Its arguments point to the processor's memory.
void run_emulated(int kernel, std::uint32_t blocks, const void* arguments);

/// Rasterizer on the emulated device, named "emulated cuda".
std::unique_ptr<Rasterizer> make_emulated_cuda_rasterizer(EmulationOrder order = EmulationOrder::Forward);

}  // namespace gse::raster::cuda
