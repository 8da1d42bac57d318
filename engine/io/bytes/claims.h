// Claims of a file, held against its size and the free memory before anything of that size is made.
#pragma once

#include <cstdint>
#include <string>

namespace gse::io {

/// Bytes of `count` splats once they are read.
std::uint64_t splat_bytes(std::uint64_t count, int sh_degree);

/// Claim of `bytes` of memory by a file of `file_bytes`.
struct Claim {
    std::uint64_t bytes = 0;
    std::uint64_t file_bytes = 0;
};

/// Most bytes that any scene, picture or list unpacks to per byte of its file. A little may come from nothing
/// (a scene of equal splats).
constexpr std::uint64_t FreeClaim = std::uint64_t{256} << 20;
constexpr std::uint64_t BytesPerFileByte = 1000;

/// Throws Error (Malformed) when a file of this size cannot honestly hold so much, and OutOfMemory when so
/// much is not free. `what` begins the sentence: "the SPZ file's 400000000 splats".
void check_claim(const Claim& claim, const std::string& what);

}  // namespace gse::io
