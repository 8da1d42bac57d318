// What reader and writer of PlayCanvas' compressed PLY share.
#pragma once

#include <cstddef>

namespace gse::io {

constexpr std::size_t CompressedChunkRows = 256;  // rows that share their bounds

}  // namespace gse::io
