// transforms.json of Blender's NeRF scenes, instant-ngp and nerfstudio: camera-to-world matrices in OpenGL
// axes.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"

namespace gse {
namespace {

using Json = nlohmann::json;

constexpr int BlenderSide = 800;  // pixels; what the scenes without a stated size and without pictures have

/// Affine map x -> linear x + offset.
struct Affine {
    Mat3 linear = Mat3::identity();
    Vec3 offset{};
};

[[noreturn]] void throw_malformed_transforms(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the transforms file " + what,
                "the file is damaged or of another kind");
}

/// Matrix of 3x4 or 4x4 numbers, by rows.
Affine affine(const Json& json) {
    if (!json.is_array() || json.size() < 3)
        throw_malformed_transforms("has a matrix with fewer than three rows");
    Affine result;
    for (int row = 0; row < 3; ++row) {
        const Json& values = json.at(static_cast<std::size_t>(row));
        for (int column = 0; column < 3; ++column)
            result.linear(row, column) = values.at(static_cast<std::size_t>(column)).get<double>();
        result.offset[row] = values.at(3).get<double>();
    }
    return result;
}

/// Inverse of a rotation (or axis exchange) and shift.
Affine inverse(const Affine& a) {
    const Mat3 transposed = a.linear.transposed();
    return {transposed, -(transposed * a.offset)};
}

Affine operator*(const Affine& a, const Affine& b) {
    return {a.linear * b.linear, a.linear * b.offset + a.offset};
}

/// Map from the world of the file to that of the splats. nerfstudio turns and scales the cameras before
/// training. It writes that map to dataparser_transforms.json beside the exported splats, counted from the
/// world before applied_transform.
struct WorldChange {
    Affine transform;
    double scale = 1;
};

WorldChange world_change(const Json& json, std::initializer_list<std::filesystem::path> folders) {
    WorldChange change;
    std::filesystem::path file;
    std::error_code ignored;
    for (const auto& folder : folders)
        if (const auto there = folder / "dataparser_transforms.json";
            file.empty() && !folder.empty() && std::filesystem::exists(there, ignored))
            file = there;
    if (file.empty()) return change;
    const Json parser = parse_json(read_file(file), "dataparser_transforms.json");
    Affine applied;
    if (json.contains("applied_transform")) applied = affine(json.at("applied_transform"));
    else  // what nerfstudio's converter did before it said so
        applied.linear = Mat3::from_rows({0, 1, 0, 1, 0, 0, 0, 0, -1});
    change.transform = affine(parser.at("transform")) * inverse(applied);
    change.scale = parser.at("scale").get<double>() / json.value("applied_scale", 1.0);
    return change;
}

/// A number of the frame, else of the file.
std::optional<double> find_number(const Json& frame, const Json& file, const char* key) {
    for (const Json* place : {&frame, &file})
        if (place->contains(key) && place->at(key).is_number()) return place->at(key).get<double>();
    return std::nullopt;
}

std::optional<ImageSize> size_of_picture(const std::filesystem::path& folder, const std::string& file_path) {
    if (folder.empty() || file_path.empty()) return std::nullopt;
    for (const char* ending : {"", ".png", ".jpg"}) {
        const std::filesystem::path picture = folder / (file_path + ending);
        std::error_code ignored;
        if (std::filesystem::is_regular_file(picture, ignored)) return read_image_size(picture);
    }
    return std::nullopt;
}

int whole_size(double value) {
    if (!(value >= 1 && value <= io::LargestImageSide))
        throw_malformed_transforms(fmt::format("has an image size of {}", value));
    return static_cast<int>(value);
}

void set_size(Camera& camera, const Json& frame, const Json& file, const std::filesystem::path& folder) {
    const auto width = find_number(frame, file, "w");
    const auto height = find_number(frame, file, "h");
    if (width && height) {
        camera.width = whole_size(*width);
        camera.height = whole_size(*height);
    } else if (const auto size = size_of_picture(folder, frame.value("file_path", std::string()))) {
        camera.width = size->width;
        camera.height = size->height;
    } else if (const auto cx = find_number(frame, file, "cx"), cy = find_number(frame, file, "cy");
               cx && cy) {
        camera.width = whole_size(std::round(2 * *cx));
        camera.height = whole_size(std::round(2 * *cy));
    } else {
        camera.width = camera.height = BlenderSide;
    }
}

void set_focal(Camera& camera, const Json& frame, const Json& file) {
    const auto from_angle = [&](const char* key, int side) -> std::optional<double> {
        const auto angle = find_number(frame, file, key);
        if (!angle) return std::nullopt;
        return 0.5 * side / std::tan(0.5 * *angle);
    };
    std::optional<double> fx = find_number(frame, file, "fl_x");
    std::optional<double> fy = find_number(frame, file, "fl_y");
    if (!fx) fx = from_angle("camera_angle_x", camera.width);
    if (!fx) fx = fy;
    if (!fx) throw_malformed_transforms("has neither fl_x nor camera_angle_x");
    camera.fx = *fx;
    camera.fy = fy.value_or(*fx);  // square pixels: fovy follows from the height
    camera.cx = find_number(frame, file, "cx").value_or(0.5 * camera.width);
    camera.cy = find_number(frame, file, "cy").value_or(0.5 * camera.height);
}

bool has_distortion(const Json& frame, const Json& file) {
    for (const Json* place : {&frame, &file}) {
        const std::string model = place->value("camera_model", std::string());
        if (!model.empty() && model != "OPENCV" && model != "PINHOLE" && model != "SIMPLE_PINHOLE")
            return true;
        if (place->value("is_fisheye", false)) return true;
    }
    for (const char* key : {"k1", "k2", "k3", "k4", "p1", "p2"})
        if (find_number(frame, file, key).value_or(0) != 0) return true;
    return false;
}

/// Sets the pose: from OpenGL axes (right, up, back) to ours (right, down, forward), then from
/// camera-to-world to world-to-camera.
void set_pose(Camera& camera, const Json& frame, const WorldChange& change) {
    Affine pose = change.transform * affine(frame.at("transform_matrix"));
    for (int row = 0; row < 3; ++row) {
        pose.linear(row, 1) = -pose.linear(row, 1);
        pose.linear(row, 2) = -pose.linear(row, 2);
    }
    // Some exporters leave a scale in the matrix; it has no meaning for a pinhole.
    for (int column = 0; column < 3; ++column) {
        const double size = length(pose.linear.columns[column]);
        if (size > 0) pose.linear.columns[column] /= size;
    }
    camera.rotation = pose.linear.transposed();
    camera.translation = -(camera.rotation * (pose.offset * change.scale));
}

}  // namespace

std::vector<View> parse_transforms_json(std::string_view text, const std::filesystem::path& folder,
                                        const std::filesystem::path& scene_folder) {
    try {
        const Json file = parse_json(text, "the transforms file");
        if (!file.is_object() || !file.contains("frames")) throw_malformed_transforms("has no frames");
        const WorldChange change = world_change(file, {scene_folder, folder});
        std::vector<View> views;
        for (const Json& frame : file.at("frames")) {
            View view;
            view.name = frame.value("file_path", fmt::format("frame_{:03}", views.size()));
            set_size(view.camera, frame, file, folder);
            set_focal(view.camera, frame, file);
            set_pose(view.camera, frame, change);
            view.distorted = has_distortion(frame, file);
            io::check_intrinsics(view.camera, "\"" + view.name + "\"");
            io::check_pose(view.camera, view.name);
            views.push_back(std::move(view));
        }
        if (views.empty()) throw_malformed_transforms("has no frames");
        return views;
    } catch (const nlohmann::json::exception& failure) {
        throw_malformed_transforms(std::string("cannot be understood (") + failure.what() + ")");
    }
}

void save_transforms_json(const std::filesystem::path& path, const std::vector<View>& views) {
    using Ordered = nlohmann::ordered_json;
    Ordered frames = Ordered::array();
    std::size_t distorted = 0;
    for (const View& view : views) {
        const Camera& camera = view.camera;
        const Vec3 centre = camera.centre();
        const Mat3 to_world = camera.rotation.transposed();
        Ordered matrix = Ordered::array();
        for (int row = 0; row < 3; ++row)  // OpenGL axes: up and back instead of down and forward
            matrix.push_back({to_world(row, 0), -to_world(row, 1), -to_world(row, 2), centre[row]});
        matrix.push_back({0.0, 0.0, 0.0, 1.0});
        distorted += view.distorted ? 1u : 0u;
        frames.push_back({{"file_path", view.name},
                          {"w", camera.width},
                          {"h", camera.height},
                          {"fl_x", camera.fx},
                          {"fl_y", camera.fy},
                          {"cx", camera.cx},
                          {"cy", camera.cy},
                          {"transform_matrix", matrix}});
    }
    // No exchange of axes: without the key nerfstudio's tools take its old converter's for granted.
    const Ordered identity = {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}};
    const Ordered file = {{"camera_model", "OPENCV"}, {"applied_transform", identity}, {"frames", frames}};
    if (distorted > 0)
        log::warning("{} of {} cameras had lens distortion; they are written as pinholes", distorted,
                     views.size());
    std::error_code ignored;
    if (std::filesystem::exists(path.parent_path() / "dataparser_transforms.json", ignored))
        log::warning(
            "beside {} lies a dataparser_transforms.json: readers turn and scale the cameras by it once more",
            path.filename().string());
    write_file(path, file.dump(1) + "\n");
}

}  // namespace gse
