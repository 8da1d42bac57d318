// What a file says it holds, held against its size and the free memory before anything of that size is made.
#pragma once

#include <cstdint>
#include <string>

namespace gse::io {

/// Bytes of `count` splats once they are read.
std::uint64_t splat_bytes(std::uint64_t count, int sh_degree);

/// Something that takes `bytes` of memory, as a file of `file_bytes` states.
struct Claim {
    std::uint64_t bytes = 0;
    std::uint64_t file_bytes = 0;
};

/// No scene, picture or list compresses better than this; a little may come from nothing (a scene of equal
/// splats).
constexpr std::uint64_t FreeClaim = std::uint64_t{256} << 20;
constexpr std::uint64_t BytesPerFileByte = 1000;

/// Throws Error (Malformed) when a file of this size cannot honestly hold so much, OutOfMemory when so much
/// is not free. `what` begins the sentence: "the SPZ file's 400000000 splats".
void check_claim(const Claim& claim, const std::string& what);

}  // namespace gse::io
