// transforms.json of Blender's NeRF scenes, instant-ngp and nerfstudio: camera-to-world matrices in OpenGL
// axes.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/bytes/letter_case.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/io/cameras/camera_models.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/cameras/json_values.h"
#include "engine/io/cameras/left_out.h"
#include "engine/io/cameras/picture_sizes.h"
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

/// Matrix of 3x4 or 4x4 numbers: rows, or all of them in a row. Throws Error (Malformed).
Affine affine(const Json& json, const char* name) {
    std::array<double, 12> rows{};
    bool read = false;
    if (json.is_array() && (json.size() == 12 || json.size() == 16)) {
        read = io::read_numbers(json, rows);
        for (std::size_t column = 12; column < json.size(); ++column)  // else the columns come first
            read = read && io::number_in(json[column]) == (column == 15 ? 1.0 : 0.0);
    } else if (json.is_array() && json.size() >= 3) {
        read = true;
        for (std::size_t row = 0; row < 3; ++row)
            read = read && io::read_numbers(json[row], std::span(rows).subspan(row * 4, 4));
    }
    if (!read)
        throw Error(ErrorCode::Malformed,
                    fmt::format("the {} is not three or four rows of four finite numbers", name));
    const Mat3 linear =
        Mat3::from_rows({rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10]});
    return {linear, {rows[3], rows[7], rows[11]}};
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
    const Json parser = io::parse_camera_json(read_file(file), "dataparser_transforms.json");
    Affine applied;
    if (json.contains("applied_transform")) applied = affine(json["applied_transform"], "applied_transform");
    else  // what nerfstudio's converter did before it said so
        applied.linear = Mat3::from_rows({0, 1, 0, 1, 0, 0, 0, 0, -1});
    return with_path(file, [&] {
        const Json transform = parser.is_object() ? parser.value("transform", Json()) : Json();
        return WorldChange{
            affine(transform, "transform") * inverse(applied),
            io::needed_number_at(parser, "scale") / io::number_at(json, "applied_scale").value_or(1)};
    });
}

/// A number of the frame, else of the file.
std::optional<double> find_number(const Json& frame, const Json& file, const char* key) {
    const auto own = io::number_at(frame, key);
    return own ? own : io::number_at(file, key);
}

int whole_size(double value) {
    if (!(value >= 1 && value <= io::LargestImageSide))
        throw Error(ErrorCode::Malformed, fmt::format("the image size is {}", value));
    return static_cast<int>(value);
}

/// Image sizes of frames: stated, of the picture, or from the principal point. Where none of them is there,
/// the size of another frame's picture is taken.
class FrameSizes {
public:
    FrameSizes(const Json& file, const std::filesystem::path& folder) : file_(file), pictures_(folder) {}

    ImageSize of(const Json& frame, const std::string& name) {
        if (const auto size = stated(frame)) return *size;
        if (const auto size = pictures_.find(io::text_at(frame, "file_path").value_or(""))) return *size;
        const auto cx = find_number(frame, file_, "cx"), cy = find_number(frame, file_, "cy");
        if (cx && cy) return {whole_size(std::round(2 * *cx)), whole_size(std::round(2 * *cy))};
        if (!assumed_) assumed_ = of_any_picture();
        unknown_.add(io::quoted(name));
        return *assumed_;
    }
    /// A note where sizes were assumed.
    std::vector<std::string> notes() const {
        if (unknown_.size() == 0) return {};
        return {
            fmt::format("the image size of {} is neither in the file nor in a picture beside it; {} x {} "
                        "pixels are assumed",
                        unknown_.text(), assumed_->width, assumed_->height)};
    }

private:
    std::optional<ImageSize> stated(const Json& frame) const {
        const auto width = find_number(frame, file_, "w"), height = find_number(frame, file_, "h");
        if (!width || !height) return std::nullopt;
        return ImageSize{whole_size(*width), whole_size(*height)};
    }
    ImageSize of_any_picture() {
        for (const Json& frame : file_.at("frames"))
            if (const auto size = pictures_.find(io::text_at(frame, "file_path").value_or(""))) return *size;
        return {BlenderSide, BlenderSide};
    }

    const Json& file_;
    io::PictureSizes pictures_;
    std::optional<ImageSize> assumed_;
    io::NameList unknown_;
};

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
    if (!fx) throw Error(ErrorCode::Malformed, "there is neither fl_x nor camera_angle_x");
    camera.fx = *fx;
    camera.fy = fy.value_or(*fx);  // square pixels: fovy follows from the height
    camera.cx = find_number(frame, file, "cx").value_or(0.5 * camera.width);
    camera.cy = find_number(frame, file, "cy").value_or(0.5 * camera.height);
}

/// Camera model of the frame, else of the file, in capitals as nerfstudio writes it. instant-ngp has a key
/// for each.
std::string model_of(const Json& frame, const Json& file) {
    for (const Json* place : {&frame, &file}) {
        if (auto model = io::text_at(*place, "camera_model"); model && !model->empty())
            return io::upper_case(*model);
        for (const char* key : {"equirectangular", "latlong"})
            if (io::flag_at(*place, key)) return io::upper_case(key);
    }
    return {};
}

bool has_distortion(const Json& frame, const Json& file) {
    const std::string model = model_of(frame, file);
    if (!model.empty() && model != "OPENCV" && model != "PINHOLE" && model != "SIMPLE_PINHOLE") return true;
    if (io::flag_at(frame, "is_fisheye") || io::flag_at(file, "is_fisheye")) return true;
    for (const char* key : {"k1", "k2", "k3", "k4", "p1", "p2"})
        if (find_number(frame, file, key).value_or(0) != 0) return true;
    return false;
}

/// Sets the pose: from OpenGL axes (right, up, back) to ours (right, down, forward), then from
/// camera-to-world to world-to-camera.
void set_pose(Camera& camera, const Json& frame, const WorldChange& change) {
    Affine pose = change.transform * affine(frame["transform_matrix"], "transform_matrix");
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

View parse_frame(const Json& frame, const std::string& name, const Json& file, FrameSizes& sizes,
                 const WorldChange& change) {
    if (!frame.is_object()) throw Error(ErrorCode::Malformed, "the entry is not an object with values");
    if (!frame.contains("transform_matrix"))
        throw Error(ErrorCode::Malformed, "there is no transform_matrix, which is the pose");
    io::refuse_without_lens(model_of(frame, file));
    View view;
    view.name = name;
    set_pose(view.camera, frame, change);
    const ImageSize size = sizes.of(frame, name);
    view.camera.width = size.width;
    view.camera.height = size.height;
    set_focal(view.camera, frame, file);
    view.distorted = has_distortion(frame, file);
    io::check_camera(view.camera);
    return view;
}

}  // namespace

CameraList parse_transforms_json(std::string_view text, const std::filesystem::path& folder,
                                 const std::filesystem::path& scene_folder) {
    const Json file = io::parse_camera_json(text, "the transforms file");
    if (!file.is_object() || !file.contains("frames")) throw_malformed_transforms("has no frames");
    const Json& frames = file.at("frames");
    if (!frames.is_array()) throw_malformed_transforms("has no list of frames");
    const WorldChange change = world_change(file, {scene_folder, folder});
    FrameSizes sizes(file, folder);
    std::vector<View> views;
    io::LeftOut left_out;
    for (std::size_t index = 0; index < frames.size(); ++index) {
        const std::string name =
            io::text_at(frames[index], "file_path").value_or(fmt::format("frame_{:03}", index));
        try {
            views.push_back(parse_frame(frames[index], name, file, sizes, change));
        } catch (const Error& error) { left_out.add(io::quoted(name), error); }
    }
    return left_out.finish(std::move(views), sizes.notes(),
                           Error(ErrorCode::Malformed, "the transforms file has no frames",
                                 "the file is damaged or of another kind"));
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
