// The two limits of a file's claims: its own size and the free memory.
#include "engine/io/bytes/claims.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/math/sh.h"

namespace gse::io {

std::uint64_t splat_bytes(std::uint64_t count, int sh_degree) {
    const auto floats = static_cast<std::uint64_t>(3 + 3 + 4 + 1 + 3 * sh_coefficient_count(sh_degree));
    return saturating_product(count, floats * sizeof(float));
}

void check_claim(const Claim& claim, const std::string& what) {
    if (claim.bytes > FreeClaim && claim.bytes / BytesPerFileByte > claim.file_bytes)
        throw Error(ErrorCode::Malformed,
                    fmt::format("{} would take {}, and a file of {} bytes cannot hold so much", what,
                                memory_text(claim.bytes), claim.file_bytes),
                    "the file is damaged or made to do harm");
    require_memory(claim.bytes, what);
}

}  // namespace gse::io
