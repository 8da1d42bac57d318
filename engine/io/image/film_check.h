// Check that a film file was closed properly. Its encoder does not say when the disk took no more.
#pragma once

#include <cstddef>
#include <span>

namespace gse::io {

/// True for an MP4 whose boxes fill the file and hold the index, or a WebM whose segment ends with the file.
/// Both are written last, so that nothing before them is missing.
bool film_is_whole(std::span<const std::byte> bytes);

}  // namespace gse::io
