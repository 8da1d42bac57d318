// PlayCanvas' compressed PLY: its constants, detection and writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/formats/scene_format.h"

namespace gse::io {

constexpr std::size_t CompressedChunkRows = 256;  // rows that share their bounds

/// True when the content begins like a compressed PLY.
bool detect_compressed_ply(Bytes bytes);
/// Bytes of a compressed PLY. Row order[i] of the usable rows became row i (`order` may be null).
std::string write_compressed_ply(const Scene& scene, std::vector<std::uint32_t>* order = nullptr);

}  // namespace gse::io
