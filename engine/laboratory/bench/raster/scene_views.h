// Cameras that a scene of one's own is measured from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::bench {

/// Up to `count` cameras, evenly spread over those of the file `cameras` (empty = found beside the scene). An
/// orbit of `width` x `height` pixels stands in where there are none, or `cameras` is "none". Throws Error
/// where the file cannot be read.
std::vector<Camera> spread_cameras(const Scene& scene, const std::filesystem::path& scene_file,
                                   const std::string& cameras, int count, int width, int height);

}  // namespace gse::bench
