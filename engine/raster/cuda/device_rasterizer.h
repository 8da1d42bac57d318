// The rasterizer whose kernels a device runs.
#pragma once

#include <memory>
#include <string>

#include "engine/raster/cuda/device.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

/// Not checked; takes the device over. `name` is what Rasterizer::name() says.
std::unique_ptr<Rasterizer> make_device_rasterizer(std::unique_ptr<Device> device, std::string name);

}  // namespace gse::raster::cuda
