// The CUDA rasterizer on a device that was opened already.
#pragma once

#include <memory>

#include "engine/raster/cuda/device.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

/// Throws Error where the device does not draw the built-in scene as the plain version does (self_check.h).
std::unique_ptr<Rasterizer> make_checked_rasterizer(std::unique_ptr<Device> device);

}  // namespace gse::raster::cuda
