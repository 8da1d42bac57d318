// A camera as JSON, as projects and pictures keep it.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "engine/math/camera.h"
#include "engine/scene/camera_key.h"

namespace gse {

nlohmann::ordered_json camera_to_json(const Camera& camera);
/// Throws nlohmann::json::exception for entries that are missing or of another kind, Error (Malformed) for
/// values that are no camera's. Without a principal point it is the middle.
Camera camera_from_json(const nlohmann::ordered_json& json);

/// A list of {"time", "camera"}; as above.
nlohmann::ordered_json camera_keys_to_json(const std::vector<CameraKey>& keys);
std::vector<CameraKey> camera_keys_from_json(const nlohmann::ordered_json& json);

}  // namespace gse
