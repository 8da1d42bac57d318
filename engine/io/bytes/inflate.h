// Decompression that grows with its real output, so that a lying size costs nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gse::io {

/// Inflates a gzip stream until its end or until `limit` bytes. Throws Error (Malformed) when the stream is
/// broken. A stream that is cut off gives the bytes before its end.
std::vector<std::byte> inflate_gzip(std::span<const std::byte> bytes, std::uint64_t limit);

/// Decompresses one zstd frame that must give exactly `size` bytes. Throws Error (Malformed).
std::vector<std::byte> decompress_zstd(std::span<const std::byte> bytes, std::uint64_t size);

/// The bytes as one gzip stream.
std::string deflate_gzip(std::string_view bytes);

/// The bytes as one zstd frame that states its size.
std::string compress_zstd(std::string_view bytes);

}  // namespace gse::io
