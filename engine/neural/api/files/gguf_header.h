// Header of a GGUF file (versions 2 and 3): statements, and the table of tensors.
#pragma once

#include <filesystem>

#include "engine/base/file.h"
#include "engine/neural/api/files/weight_header.h"

namespace gse::neural {

/// Reads no more than LongestGgufHeader bytes. Lists of statements are passed over. Throws Error (Malformed,
/// Unreadable); `path` is for the message.
WeightHeader read_gguf_header(const InputFile& file, const std::filesystem::path& path);

constexpr std::uint64_t LongestGgufHeader = std::uint64_t{64} << 20;  // bytes

}  // namespace gse::neural
