// Cameras to JSON and back.
#include "engine/io/cameras/camera_json.h"

#include <cmath>

#include "engine/base/error.h"

namespace gse {
namespace {

constexpr int LargestSide = 65535;

}  // namespace

nlohmann::ordered_json camera_to_json(const Camera& camera) {
    nlohmann::ordered_json json{{"fx", camera.fx}, {"fy", camera.fy},       {"cx", camera.cx},
                                {"cy", camera.cy}, {"width", camera.width}, {"height", camera.height}};
    json["rotation"] = camera.rotation.rows();
    json["translation"] = {camera.translation.x, camera.translation.y, camera.translation.z};
    return json;
}

Camera camera_from_json(const nlohmann::ordered_json& json) {
    Camera camera;
    camera.width = json.at("width").get<int>();
    camera.height = json.at("height").get<int>();
    camera.fx = json.at("fx").get<double>();
    camera.fy = json.at("fy").get<double>();
    camera.cx = json.value("cx", camera.width / 2.0);
    camera.cy = json.value("cy", camera.height / 2.0);
    for (int i = 0; i < 9; ++i)
        camera.rotation(i / 3, i % 3) = json.at("rotation").at(static_cast<std::size_t>(i)).get<double>();
    const auto& translation = json.at("translation");
    camera.translation = {translation.at(0).get<double>(), translation.at(1).get<double>(),
                          translation.at(2).get<double>()};
    const bool sane = camera.width > 0 && camera.height > 0 && camera.width <= LargestSide &&
                      camera.height <= LargestSide && camera.fx > 0 && camera.fy > 0 &&
                      std::isfinite(camera.fx) && std::isfinite(camera.fy) && std::isfinite(camera.cx) &&
                      std::isfinite(camera.cy) && std::isfinite(length(camera.centre()));
    if (!sane) throw Error(ErrorCode::Malformed, "a camera holds values that no camera has");
    return camera;
}

nlohmann::ordered_json camera_keys_to_json(const std::vector<CameraKey>& keys) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& key : keys) json.push_back({{"time", key.time}, {"camera", camera_to_json(key.camera)}});
    return json;
}

std::vector<CameraKey> camera_keys_from_json(const nlohmann::ordered_json& json) {
    std::vector<CameraKey> keys;
    for (const auto& entry : json)
        keys.push_back({entry.at("time").get<double>(), camera_from_json(entry.at("camera"))});
    return keys;
}

}  // namespace gse
