// One call reads anything that shows a scene: a scene file, a folder or a project.
#pragma once

#include <filesystem>

#include "engine/scene/scene.h"

namespace gse {

/// Reads whatever load_scene_file() reads, and of a project (.gsep) its scene with the edits that are on.
/// Throws Error with one clear sentence, also when projects refer to each other as their scenes.
Scene load_scene(const std::filesystem::path& path);

}  // namespace gse
