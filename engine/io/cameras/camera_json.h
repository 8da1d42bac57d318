// A camera as JSON, in projects and pictures.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "engine/math/camera.h"
#include "engine/scene/camera_key.h"

namespace gse {

nlohmann::ordered_json camera_to_json(const Camera& camera);
/// Camera from JSON. Throws nlohmann::json::exception for entries that are missing or of another kind, Error
/// (Malformed) for values that are no camera's. The principal point is the middle if it is missing.
Camera camera_from_json(const nlohmann::ordered_json& json);

/// Camera path from a list of {"time", "camera"}. Throws as above.
nlohmann::ordered_json camera_keys_to_json(const std::vector<CameraKey>& keys);
std::vector<CameraKey> camera_keys_from_json(const nlohmann::ordered_json& json);

}  // namespace gse
