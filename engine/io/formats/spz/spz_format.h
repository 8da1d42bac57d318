// What reader and writer of .spz files share.
#pragma once

#include <cstdint>

namespace gse::io {

constexpr std::uint32_t SpzMagic = 0x5053474e;  // "NGSP"
constexpr double SpzColourScale = 0.15;         // not ShC0: the format keeps a wider range

}  // namespace gse::io
