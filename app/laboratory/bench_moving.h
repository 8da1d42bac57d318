// Pictures per second of the viewport while the camera moves (dynamic resolution).
#pragma once

#include <nlohmann/json.hpp>

#include "engine/scene/scene.h"

namespace gse::app {

/// Turns the camera for some seconds with the native preview as the window uses it. Returns
/// {"pictures_per_second", "scale"}; "scale" is the mean share of the full width.
nlohmann::ordered_json bench_moving(const Scene& scene, int width, int height);

}  // namespace gse::app
