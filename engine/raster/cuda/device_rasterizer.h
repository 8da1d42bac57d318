// Rasterizer whose kernels a device runs.
#pragma once

#include <memory>
#include <string>

#include "engine/raster/cuda/device.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

/// Rasterizer on an unchecked device, which it takes over. `name` is the result of Rasterizer::name().
std::unique_ptr<Rasterizer> make_device_rasterizer(std::unique_ptr<Device> device, std::string name);

}  // namespace gse::raster::cuda
