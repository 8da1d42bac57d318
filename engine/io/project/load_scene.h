// One call reads anything that shows a scene: a scene file, a folder or a project.
#pragma once

#include <filesystem>

#include "engine/io/scene/reading_options.h"
#include "engine/scene/scene.h"

namespace gse {

/// Reads the scene of a file or folder (see load_scene_file()), or of a project (.gsep) with the edits that
/// are on. Throws Error with one clear sentence, also when projects refer to each other as their scenes.
/// Options are those of a file; a project remembers its own.
Scene load_scene(const std::filesystem::path& path, const ReadingOptions& options = {});

}  // namespace gse
