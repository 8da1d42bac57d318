// Scene files that can hold a label.
#pragma once

#include <filesystem>

#include "engine/io/formats/scene_formats.h"

namespace gse::app {

/// Tells whether a scene file of this name has columns for a label.
inline bool has_room_for_labels(const std::filesystem::path& output) {
    const io::SceneFormat* format = format_written_to(output);
    return format != nullptr && format->keeps_labels;
}

}  // namespace gse::app
