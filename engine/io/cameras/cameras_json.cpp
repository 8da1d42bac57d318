// cameras.json of 3DGS training: camera centre, camera-to-world rotation by rows, focal lengths in pixels.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/bytes/json_numbers.h"
#include "engine/io/bytes/letter_case.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/cameras/json_values.h"
#include "engine/io/cameras/left_out.h"

namespace gse {
namespace {

using Json = nlohmann::json;

constexpr double CentreTolerance = 0.5;  // pixels off the image centre before the loss is worth a word

/// Rotation by rows: three lists of three numbers, or nine in a row.
Mat3 rotation_of(const Json& json) {
    std::array<double, 9> rows{};
    bool read = false;
    if (json.is_array() && json.size() == 9) {
        read = io::read_numbers(json, rows);
    } else if (json.is_array() && json.size() >= 3) {
        read = true;
        for (std::size_t row = 0; row < 3; ++row)
            read = read && io::read_numbers(json[row], std::span(rows).subspan(row * 3, 3));
    }
    if (!read)
        throw Error(ErrorCode::Malformed,
                    "the rotation is not three rows of three finite numbers, or nine in a row");
    return Mat3::from_rows(rows);
}

/// Angle of a field of view in radians. Files hold degrees too; no camera has less than half of a circle in
/// degrees and more than that in radians.
double angle_of(double value) {
    const double angle = value > std::numbers::pi ? value * std::numbers::pi / 180 : value;
    if (!(angle > 0 && angle < std::numbers::pi))
        throw Error(ErrorCode::Malformed, fmt::format("the field of view is {}", value));
    return angle;
}

/// Fields of view of a camera, in radians, by the names that tools give them.
struct Fov {
    std::optional<double> x, y, unnamed;
};

Fov fov_of(const Json& json) {
    Fov fov;
    for (const auto& [key, value] : json.items()) {
        std::string name = io::lower_case(key);
        std::erase(name, '_');
        const auto number = io::number_in(value);
        if (!number) continue;
        if (name == "fovx" || name == "cameraanglex") fov.x = angle_of(*number);
        if (name == "fovy" || name == "cameraangley") fov.y = angle_of(*number);
        if (name == "fov") fov.unnamed = angle_of(*number);
    }
    return fov;
}

double focal_length(double angle, int side) { return 0.5 * side / std::tan(0.5 * angle); }

/// Sets the focal lengths, from fields of view where there are none. Pixels are square where one of two is
/// missing. Returns true where a field of view had to be taken as the vertical one.
bool set_focal_lengths(Camera& camera, const Json& json) {
    auto fx = io::number_at(json, "fx"), fy = io::number_at(json, "fy");
    bool assumed = false;
    if (!fx && !fy) {
        const Fov fov = fov_of(json);
        if (fov.x) fx = focal_length(*fov.x, camera.width);
        if (fov.y) fy = focal_length(*fov.y, camera.height);
        assumed = !fx && !fy && fov.unnamed && camera.width != camera.height;
        if (!fx && !fy && fov.unnamed) fy = focal_length(*fov.unnamed, camera.height);
    }
    if (!fx && !fy)
        throw Error(ErrorCode::Malformed, "there is neither a focal length fx nor a field of view");
    camera.fx = fx ? *fx : *fy;
    camera.fy = fy ? *fy : *fx;
    return assumed;
}

View parse_view(const Json& json, std::string name, io::NameList& assumed) {
    if (!json.is_object()) throw Error(ErrorCode::Malformed, "the entry is not an object with values");
    View view;
    view.name = std::move(name);
    Camera& camera = view.camera;
    const auto side = [&](const char* key) {
        return static_cast<int>(io::whole_number(io::needed_number_at(json, key), io::LargestImageSide, key));
    };
    camera.width = side("width");
    camera.height = side("height");
    const bool taken_as_vertical = set_focal_lengths(camera, json);
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
    std::array<double, 3> position{};
    if (!json.contains("position") || !io::read_numbers(json["position"], position))
        throw Error(ErrorCode::Malformed, "the position is not three finite numbers");
    if (!json.contains("rotation")) throw Error(ErrorCode::Malformed, "there is no rotation");
    camera.rotation = rotation_of(json["rotation"]).transposed();
    camera.translation = -(camera.rotation * Vec3{position[0], position[1], position[2]});
    io::check_camera(camera);
    if (taken_as_vertical) assumed.add(io::quoted(view.name));
    return view;
}

}  // namespace

CameraList parse_cameras_json(std::string_view text) {
    const Json json = io::parse_camera_json(text, "cameras.json");
    if (!json.is_array()) throw Error(ErrorCode::Malformed, "cameras.json is not a list of cameras");
    std::vector<View> views;
    io::LeftOut left_out;
    io::NameList assumed;
    for (std::size_t index = 0; index < json.size(); ++index) {
        std::string name = io::text_at(json[index], "img_name").value_or(fmt::format("camera_{:03}", index));
        try {
            views.push_back(parse_view(json[index], name, assumed));
        } catch (const Error& error) { left_out.add(io::quoted(name), error); }
    }
    std::vector<std::string> notes;
    if (assumed.size() > 0)
        notes.push_back(
            fmt::format("the field of view \"fov\" of {} is taken as the vertical one", assumed.text()));
    return left_out.finish(std::move(views), std::move(notes),
                           Error(ErrorCode::Malformed, "cameras.json lists no cameras"));
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
