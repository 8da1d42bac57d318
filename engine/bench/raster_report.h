// What a measurement of the rasterizer says, for files and scripts.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/raster/bench.h"

namespace gse::bench {

/// Times in milliseconds, per pair of splat and tile in nanoseconds, memory in MiB, errors against the plain version.
nlohmann::ordered_json raster_report(const raster::RasterBench& bench);

}  // namespace gse::bench
