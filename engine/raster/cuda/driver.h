// CUDA devices through the driver alone (libcuda, opened on demand). No toolkit is needed to build or to run.
#pragma once

#include <memory>
#include <string>

#include "engine/raster/cuda/device.h"

namespace gse::raster::cuda {

inline constexpr const char* DriverLibrary = "libcuda.so.1";

/// The kernels as PTX text for compute capability 6.0 and newer. Empty if the build had no clang.
const std::string& kernel_text();

/// The first device, with the kernels loaded. `library` is the driver's name or path. Throws Error of one
/// sentence: Unsupported (no kernels in this build, a device too old), NotFound (no driver, no device),
/// Foreign (the driver refuses).
std::unique_ptr<Device> open_cuda_device(const std::string& library = DriverLibrary);

}  // namespace gse::raster::cuda
