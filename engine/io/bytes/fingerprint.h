// Recognition of a scene's file without reading all of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace gse::io {

struct Fingerprint {
    std::uint64_t bytes = 0;
    std::uint64_t value = 0;
};

/// Fingerprint of a file: its size, the first and last MiB and 64 pages in between. For a folder: names and
/// sizes of its files. Nothing when it cannot be read.
std::optional<Fingerprint> fingerprint(const std::filesystem::path& path);

/// FNV-1a hash, 64 bits. Continues from `state`.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t state = 0xcbf29ce484222325ULL);

}  // namespace gse::io
