// cameras.json of 3DGS training: camera centre, camera-to-world rotation by rows, focal lengths in pixels.
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/io/bytes/json_numbers.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/io/cameras/cameras.h"

namespace gse {
namespace {

using Json = nlohmann::json;

constexpr double CentreTolerance = 0.5;  // pixels off the image centre before the loss is worth a word

View parse_view(const Json& json, std::size_t index) {
    View view;
    Camera& camera = view.camera;
    view.name = json.value("img_name", fmt::format("camera_{:03}", index));
    camera.width =
        static_cast<int>(io::whole_number(json.at("width"), io::LargestImageSide, "width of a camera"));
    camera.height =
        static_cast<int>(io::whole_number(json.at("height"), io::LargestImageSide, "height of a camera"));
    camera.fx = json.at("fx").get<double>();
    camera.fy = json.at("fy").get<double>();
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
    Mat3 to_world;
    Vec3 centre;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            to_world(row, column) = json.at("rotation")
                                        .at(static_cast<std::size_t>(row))
                                        .at(static_cast<std::size_t>(column))
                                        .get<double>();
        centre[row] = json.at("position").at(static_cast<std::size_t>(row)).get<double>();
    }
    camera.rotation = to_world.transposed();
    camera.translation = -(camera.rotation * centre);
    io::check_intrinsics(camera, "\"" + view.name + "\"");
    io::check_pose(camera, view.name);
    return view;
}

}  // namespace

std::vector<View> parse_cameras_json(std::string_view text) {
    try {
        const Json json = parse_json(text, "cameras.json");
        if (!json.is_array()) throw Error(ErrorCode::Malformed, "cameras.json is not a list of cameras");
        std::vector<View> views;
        for (const Json& entry : json) views.push_back(parse_view(entry, views.size()));
        if (views.empty()) throw Error(ErrorCode::Malformed, "cameras.json lists no cameras");
        return views;
    } catch (const nlohmann::json::exception& failure) {
        throw Error(ErrorCode::Malformed,
                    std::string("cameras.json cannot be understood (") + failure.what() + ")",
                    "the file is damaged or of another kind");
    }
}

void save_cameras_json(const std::filesystem::path& path, const std::vector<View>& views) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    bool off_centre = false;
    for (const View& view : views) {
        const Camera& camera = view.camera;
        const Vec3 centre = camera.centre();
        nlohmann::ordered_json rotation = nlohmann::ordered_json::array();
        for (int row = 0; row < 3; ++row)
            rotation.push_back({camera.rotation(0, row), camera.rotation(1, row), camera.rotation(2, row)});
        off_centre |= std::abs(camera.cx - 0.5 * camera.width) > CentreTolerance ||
                      std::abs(camera.cy - 0.5 * camera.height) > CentreTolerance;
        list.push_back({{"id", list.size()},
                        {"img_name", view.name},
                        {"width", camera.width},
                        {"height", camera.height},
                        {"position", {centre.x, centre.y, centre.z}},
                        {"rotation", rotation},
                        {"fy", camera.fy},
                        {"fx", camera.fx}});
    }
    if (off_centre)
        log::warning("cameras.json cannot hold a principal point; it will be read as the image centre");
    write_file(path, list.dump(1) + "\n");
}

}  // namespace gse
