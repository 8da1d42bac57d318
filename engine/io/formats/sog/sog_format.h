// Reader and writer of SOG scenes: archives, unpacked folders and streamed levels of detail.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/io/formats/scene_format.h"

namespace gse::io {

/// Reads a .sog archive: a zip of meta.json and WebP textures. Throws Error.
Scene parse_sog(Bytes bytes);
/// Bytes of a SOG archive, version 2. Row order[i] of the usable rows became row i (`order` may be null).
/// Throws Error (InvalidArgument) without a splat or with more than the textures have room for.
std::string write_sog(const Scene& scene, std::vector<std::uint32_t>* order = nullptr);

}  // namespace gse::io
