// The kernels for a CUDA device. clang compiles them without a toolkit to PTX text, which the driver
// translates for its device.
#include "engine/raster/conventions.h"
#include "engine/raster/cuda/arguments.h"
#include "engine/raster/cuda/grid.h"

namespace gse::raster::cuda {
namespace {

// What is written for the processor's vectors runs here, too.
#pragma clang force_cuda_host_device begin
// clang-format off
#include "engine/raster/cuda/kernels.inl"
// clang-format on
#pragma clang force_cuda_host_device end

}  // namespace

#define GSE_KERNEL(name, Arguments, body)                                                               \
    extern "C" __attribute__((global, launch_bounds(256))) void gse_##name(const Arguments arguments) { \
        body(Grid{static_cast<std::uint32_t>(__nvvm_read_ptx_sreg_ctaid_x())}, arguments);              \
    }
#include "engine/raster/cuda/kernel_list.inl"
static_assert(BlockThreads == 256);

}  // namespace gse::raster::cuda
