// Forward and backward of the rasterizer against what this machine could do at best, for scenes and pictures
// of some sizes.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/laboratory/bench/charts/subject.h"

namespace gse::bench {

struct FloorCase {
    std::size_t splats = 0;
    int width = 0, height = 0;
};

/// "100000@512x512 500000@512x512"; may be empty. Throws Error (InvalidArgument).
std::vector<FloorCase> floor_cases_in_list(const std::string& text);

/// floor_report() of each with the fastest kernels and a thread per core, with "splats" and "picture". Throws
/// Error when stopped.
nlohmann::ordered_json bench_floor_cases(const std::vector<FloorCase>& cases, std::uint64_t seed, int views,
                                         int repetitions, const JobControl& job);

Table floor_table(const nlohmann::ordered_json& cases);

/// "forward and backward 14.6 ms, floor 12.1 ms: 1.21 times ..." of one report.
std::string floor_text(const nlohmann::ordered_json& report);

}  // namespace gse::bench
