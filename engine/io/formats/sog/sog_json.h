// Descriptions of SOG scenes, and the errors of broken ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/json.h"

namespace gse::io {

/// Largest number of splats, since a WebP picture has no more texels.
constexpr std::uint64_t LargestSogCount = std::uint64_t{16383} * 16383;

[[noreturn]] inline void throw_malformed_sog(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the SOG scene " + what,
                "the file is damaged or written by an unknown version");
}

inline nlohmann::json parse_sog_json(std::span<const std::byte> bytes) {
    const char* text = reinterpret_cast<const char*>(bytes.data());
    return parse_json({text, bytes.size()}, "the description of the SOG scene");
}

/// Translates JSON exceptions (missing keys, wrong types) into Error.
template <class F> auto with_sog_errors(F&& body) {
    try {
        return body();
    } catch (const nlohmann::json::exception& failure) {
        throw_malformed_sog(std::string("has a description that cannot be understood (") + failure.what() +
                            ")");
    }
}

}  // namespace gse::io
