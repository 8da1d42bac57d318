// Label weights: any numbers in files, numbers between 0 and 1 in labels.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace gse::io {

/// Brings every weight into [0,1], NaN to 0. Returns how many were outside.
inline std::size_t hold_weights(std::span<float> weights) {
    std::size_t held = 0;
    for (float& weight : weights) {
        if (weight >= 0 && weight <= 1) continue;
        weight = weight > 1 ? 1.0f : 0.0f;
        ++held;
    }
    return held;
}

/// Warning for `held` weights that were outside. `where` begins it.
inline std::string held_weights_text(std::size_t held, std::string_view where) {
    return fmt::format(
        "{} has weights outside of 0 to 1 for {} splats: they are taken as the nearer of the two", where,
        held);
}

}  // namespace gse::io
