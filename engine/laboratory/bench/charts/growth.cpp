// A line through logarithms.
#include "engine/laboratory/bench/charts/growth.h"

#include <cmath>

namespace gse::bench {

std::optional<double> growth_exponent(const std::vector<std::array<double, 2>>& size_and_cost) {
    std::vector<std::array<double, 2>> logs;
    double mean_x = 0, mean_y = 0;
    for (const auto& [size, cost] : size_and_cost) {
        if (!(size > 0) || !(cost > 0) || !std::isfinite(size) || !std::isfinite(cost)) continue;
        logs.push_back({std::log(size), std::log(cost)});
        mean_x += logs.back()[0], mean_y += logs.back()[1];
    }
    if (logs.size() < 2) return {};
    const auto count = static_cast<double>(logs.size());
    mean_x /= count, mean_y /= count;
    double along = 0, wide = 0;
    for (const auto& [x, y] : logs) {
        along += (x - mean_x) * (y - mean_y);
        wide += (x - mean_x) * (x - mean_x);
    }
    constexpr double least = 1e-12;  // sizes that are all the same
    return wide > least ? std::optional(along / wide) : std::nullopt;
}

}  // namespace gse::bench
