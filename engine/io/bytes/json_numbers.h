// Whole numbers from JSON. A number out of range is an error, not undefined behaviour.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"

namespace gse::io {

/// Number in [0, highest], which must be below 2^53. Fractions are cut.
inline std::uint64_t whole_number(const nlohmann::json& json, std::uint64_t highest, const char* what) {
    const double value = json.is_number() ? json.get<double>() : std::nan("");
    if (!(value >= 0 && value <= static_cast<double>(highest)))
        throw Error(ErrorCode::Malformed, fmt::format("the {} is not a number from 0 to {}", what, highest),
                    "the file is damaged or of another kind");
    return static_cast<std::uint64_t>(value);
}

}  // namespace gse::io
