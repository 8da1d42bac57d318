// How many pictures a second the viewport shows while the camera moves (dynamic resolution).
#pragma once

#include <nlohmann/json.hpp>

#include "engine/scene/scene.h"

namespace gse::app {

/// Turns the camera for some seconds with the native preview as the window uses it: {"pictures_per_second",
/// "scale"}, the latter the mean share of the full width.
nlohmann::ordered_json bench_moving(const Scene& scene, int width, int height);

}  // namespace gse::app
