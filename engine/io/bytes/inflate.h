// Decompression that grows with its real output, so that a lying size costs nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gse::io {

/// True when the bytes begin like a gzip stream.
bool is_gzip(std::span<const std::byte> bytes);

/// Inflates a gzip stream until its end or until `limit` bytes. Several members one after the other are one
/// stream. Throws Error (Malformed) when the stream is broken. A stream that is cut off gives the bytes
/// before its end.
std::vector<std::byte> inflate_gzip(std::span<const std::byte> bytes, std::uint64_t limit);

/// Unpacks a whole gzip stream out of a file of `file_bytes`. Its size is counted and held against the file's
/// and the free memory before any of it is kept. Throws Error (Malformed) when it is broken, cut off or too
/// large to be honest, and OutOfMemory.
std::vector<std::byte> unpack_gzip(std::span<const std::byte> bytes, std::uint64_t file_bytes);

/// Decompresses one zstd frame that must give exactly `size` bytes. Throws Error (Malformed).
std::vector<std::byte> decompress_zstd(std::span<const std::byte> bytes, std::uint64_t size);

/// The bytes as one gzip stream.
std::string deflate_gzip(std::string_view bytes);

/// The bytes as one zstd frame that states its size.
std::string compress_zstd(std::string_view bytes);

}  // namespace gse::io
