// Scenes by their content first and their names second, wrapped ones too.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/formats/scene_format.h"

namespace gse::io {

/// Place of bytes in a file on the disk: the wrappers around them, and the file's size.
struct Wrapping {
    int depth = 0;
    std::uint64_t file_bytes = 0;
};

/// Reads the scene in these bytes, as parse_scene() says.
Scene read_content(Bytes bytes, std::string_view name, const Wrapping& wrapping);

/// True when a file of that name (in lower case) is of the format.
bool has_extension_of(const SceneFormat& format, std::string_view name);
/// True when a file of that name (in lower case) is a scene: by its ending, unless its format says that the
/// content is something else. `start` gives the first bytes, and is called where they matter.
bool looks_like_scene(std::string_view name, const std::function<std::string()>& start);
/// N of a folder "iteration_N", or -1. Capitals do not matter.
long iteration_of(const std::string& folder_name);
/// Sentence part on the formats that can be read.
std::string readable_hint();
/// The first few names: "a.ply, b.ply, ...".
std::string some_of(const std::vector<std::string>& names);

}  // namespace gse::io
