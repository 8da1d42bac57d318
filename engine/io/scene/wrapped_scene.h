// Scenes inside of gzip streams and zip archives, as they come from downloads.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/io/scene/scene_content.h"

namespace gse::io {

/// True for a name (in lower case) that promises a scene inside: "a.ply.gz", "a.ssproj". A zip archive may
/// hold anything.
bool is_packed_scene(const std::string& lower_name);

/// Reads the scene in a gzip stream. `name` is that of the file in lower case; ".gz" at its end is dropped.
/// Throws Error.
Scene read_gzip(Bytes bytes, const std::string& name, const Wrapping& wrapping);

/// Reads the one scene in a zip archive: a scene file, a SOG scene with its textures, the highest iteration
/// of a training, or a SuperSplat project. Throws Error, and names the scenes where there are several.
Scene read_zip(Bytes bytes, const std::string& name, const Wrapping& wrapping);

}  // namespace gse::io
