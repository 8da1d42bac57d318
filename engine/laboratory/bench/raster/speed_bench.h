// gseditpro-lab bench speed: what rasterizer and preview cost on generated scenes, as a Markdown table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gse::bench {

struct SpeedBenchOptions {
    std::vector<std::size_t> splats{100000, 500000};
    std::uint64_t seed = 0;
    int views = 16;
    int repetitions = 3;  // of the rasterizer's rounds over all views
    int raster_width = 512, raster_height = 512;
    int preview_width = 1280, preview_height = 720;
    std::filesystem::path scenes_folder;  // where scenes and cameras are written; empty = nowhere
};

/// Processor time of all threads per picture (median), each beside its error against the double-precision
/// version. Processor time, because wall time says what else the machine does.
std::string speed_table(const SpeedBenchOptions& options);

}  // namespace gse::bench
