// Report of a measurement of the rasterizer, for files and scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "engine/raster/bench.h"
#include "engine/raster/skip_bench.h"

namespace gse::bench {

/// Times in milliseconds, per pair of splat and tile in nanoseconds, memory in MiB, errors against the plain
/// version.
nlohmann::ordered_json raster_report(const raster::RasterBench& bench);

/// Report of an edit's iterations with and without skips: processor time in milliseconds, memory in MiB, and
/// differences of the results.
nlohmann::ordered_json skip_report(const std::vector<raster::SkipBench>& shares);

/// The floor of forward and backward, what it is made of, and how far the rasterizer is from it.
nlohmann::ordered_json floor_report(const raster::RasterBench& bench);

}  // namespace gse::bench
