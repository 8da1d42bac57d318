// Constants and writer of .spz files.
#pragma once

#include <cstdint>
#include <string>

#include "engine/io/formats/scene_format.h"

namespace gse::io {

constexpr std::uint32_t SpzMagic = 0x5053474e;  // "NGSP"
constexpr double SpzColourScale = 0.15;         // not ShC0: the format keeps a wider range

constexpr int OldestSpzVersion = 2, UsualSpzVersion = 3, NewestSpzVersion = 4;  // that are written

/// Bytes of a .spz file of that version. Throws Error (InvalidArgument) for another than those above.
std::string write_spz(const Scene& scene, int version = UsualSpzVersion);

}  // namespace gse::io
