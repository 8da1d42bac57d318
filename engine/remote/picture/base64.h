// Base64 as servers exchange pictures in JSON.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gse::remote {

/// Standard alphabet, padded, without line breaks.
std::string base64_encoded(std::span<const std::byte> bytes);

/// Bytes of a strictly written text: standard alphabet, length a multiple of 4, right padding, no unused bits
/// set. A prefix "data:...;base64," is passed over. Throws Error (Malformed).
std::vector<std::byte> base64_decoded(std::string_view text);

}  // namespace gse::remote
