// COLMAP sparse models, binary and text: intrinsics of cameras, poses of images. Points are not read.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/io/cameras/cameras.h"

namespace gse {
namespace {

using io::ByteReader;

/// Camera model of `params` numbers. The first `focals` are focal lengths, then cx, cy (unless spherical).
struct Model {
    std::string_view name;
    std::size_t params;
    std::size_t focals;  // 1 = fx is fy; 0 = no pinhole at all
    bool perspective;    // a pinhole when everything after cx, cy is zero
};

/// Camera models; the index is COLMAP's model number.
constexpr std::array<Model, 18> Models = {{{"SIMPLE_PINHOLE", 3, 1, true},
                                           {"PINHOLE", 4, 2, true},
                                           {"SIMPLE_RADIAL", 4, 1, true},
                                           {"RADIAL", 5, 1, true},
                                           {"OPENCV", 8, 2, true},
                                           {"OPENCV_FISHEYE", 8, 2, false},
                                           {"FULL_OPENCV", 12, 2, true},
                                           {"FOV", 5, 2, false},
                                           {"SIMPLE_RADIAL_FISHEYE", 4, 1, false},
                                           {"RADIAL_FISHEYE", 5, 1, false},
                                           {"THIN_PRISM_FISHEYE", 12, 2, false},
                                           {"RAD_TAN_THIN_PRISM_FISHEYE", 16, 2, false},
                                           {"SIMPLE_DIVISION", 4, 1, true},
                                           {"DIVISION", 5, 2, true},
                                           {"SIMPLE_FISHEYE", 3, 1, false},
                                           {"FISHEYE", 4, 2, false},
                                           {"EUCM", 6, 2, false},
                                           {"EQUIRECTANGULAR", 2, 0, false}}};
constexpr std::size_t MostParams = 16;
constexpr std::uint64_t LeastCameraBytes = 24 + 2 * 8;
constexpr std::uint64_t LeastImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr std::uint64_t PointBytes = 24;
constexpr double LargestSize = 1e5;  // pixels

/// Intrinsics only. The pose comes from the image.
struct Intrinsics {
    Camera camera;
    bool distorted = false;
};
using Cameras = std::map<std::uint32_t, Intrinsics>;

[[noreturn]] void throw_malformed_colmap(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the COLMAP model " + what, "the file is damaged or not from COLMAP");
}

Intrinsics make_intrinsics(const Model& model, double width, double height, std::span<const double> params) {
    if (!(width >= 1 && width <= LargestSize && height >= 1 && height <= LargestSize))
        throw_malformed_colmap(fmt::format("has a camera of {} x {} pixels", width, height));
    Intrinsics result;
    Camera& camera = result.camera;
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    if (model.focals == 0) {
        // A panorama has no pinhole; a quarter of it (90 degrees) is shown from its place.
        camera.fx = camera.fy = 0.5 * camera.height;
        camera.cx = 0.5 * width;
        camera.cy = 0.5 * height;
        result.distorted = true;
        return result;
    }
    camera.fx = params[0];
    camera.fy = params[model.focals - 1];
    camera.cx = params[model.focals];
    camera.cy = params[model.focals + 1];
    const auto extra = params.subspan(model.focals + 2);
    result.distorted = !model.perspective ||
                       std::any_of(extra.begin(), extra.end(), [](double value) { return value != 0; });
    io::check_intrinsics(camera, "of the COLMAP model");
    return result;
}

/// Camera of an image. q (w,x,y,z) and t are world to camera.
View make_view(std::string_view name, const std::array<double, 7>& pose, const Intrinsics& intrinsics) {
    View view;
    view.name = std::string(name);
    view.camera = intrinsics.camera;
    view.distorted = intrinsics.distorted;
    const Quat q{pose[0], pose[1], pose[2], pose[3]};
    if (!(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z > 0))
        throw_malformed_colmap(fmt::format("has no rotation for \"{}\"", name));
    view.camera.rotation = rotation_matrix(q);
    view.camera.translation = {pose[4], pose[5], pose[6]};
    io::check_pose(view.camera, view.name);
    return view;
}

const Intrinsics& find_camera(const Cameras& cameras, std::uint32_t id) {
    const auto found = cameras.find(id);
    if (found == cameras.end())
        throw_malformed_colmap(fmt::format("has an image of camera {}, which is not there", id));
    return found->second;
}

/// Sorts by name, since COLMAP's own order is that of a hash table.
std::vector<View> sorted(std::vector<View> views) {
    if (views.empty()) throw_malformed_colmap("has no images");
    std::stable_sort(views.begin(), views.end(),
                     [](const View& a, const View& b) { return a.name < b.name; });
    return views;
}

Cameras parse_binary_cameras(std::span<const std::byte> bytes) {
    ByteReader reader(bytes, "cameras.bin");
    Cameras cameras;
    const std::uint64_t count = reader.read_count(LeastCameraBytes);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto id = reader.read<std::uint32_t>();
        const auto model = reader.read<std::int32_t>();
        if (model < 0 || static_cast<std::size_t>(model) >= Models.size())
            throw Error(ErrorCode::Unsupported,
                        fmt::format("the COLMAP camera model number {} is not known", model));
        const auto width = static_cast<double>(reader.read<std::uint64_t>());
        const auto height = static_cast<double>(reader.read<std::uint64_t>());
        const Model& known = Models[static_cast<std::size_t>(model)];
        std::array<double, MostParams> params{};
        for (std::size_t p = 0; p < known.params; ++p) params[p] = reader.read<double>();
        cameras[id] = make_intrinsics(known, width, height, {params.data(), known.params});
    }
    return cameras;
}

// ---- text ----

class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {}
    bool next(std::string_view& line) {
        if (offset_ >= text_.size()) return false;
        const std::size_t end = std::min(text_.find('\n', offset_), text_.size());
        line = text_.substr(offset_, end - offset_);
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        offset_ = end + 1;
        return true;
    }

private:
    std::string_view text_;
    std::size_t offset_ = 0;
};

std::string_view next_word(std::string_view& rest) {
    const std::size_t begin = std::min(rest.find_first_not_of(" \t"), rest.size());
    rest.remove_prefix(begin);
    const std::size_t size = std::min(rest.find_first_of(" \t"), rest.size());
    const std::string_view word = rest.substr(0, size);
    rest.remove_prefix(size);
    return word;
}

template <class T> T number(std::string_view word, const char* where) {
    T value{};
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure != std::errc{} || end != word.data() + word.size())
        throw_malformed_colmap(
            fmt::format("has \"{}\" where a number belongs in {}", word.substr(0, 24), where));
    return value;
}

bool is_comment_or_blank(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t");
    return first == std::string_view::npos || line[first] == '#';
}

Cameras parse_text_cameras(std::string_view text) {
    Cameras cameras;
    Lines lines(text);
    std::string_view line;
    while (lines.next(line)) {
        if (is_comment_or_blank(line)) continue;
        const auto id = number<std::uint32_t>(next_word(line), "cameras.txt");
        const std::string_view name = next_word(line);
        const auto* model =
            std::find_if(Models.begin(), Models.end(), [&](const Model& m) { return m.name == name; });
        if (model == Models.end())
            throw Error(ErrorCode::Unsupported,
                        fmt::format("the COLMAP camera model \"{}\" is not known", name.substr(0, 32)));
        const auto width = number<double>(next_word(line), "cameras.txt");
        const auto height = number<double>(next_word(line), "cameras.txt");
        std::array<double, MostParams> params{};
        for (std::size_t p = 0; p < model->params; ++p)
            params[p] = number<double>(next_word(line), "cameras.txt");
        cameras[id] = make_intrinsics(*model, width, height, {params.data(), model->params});
    }
    return cameras;
}

}  // namespace

std::vector<View> parse_colmap_binary(std::span<const std::byte> camera_bytes,
                                      std::span<const std::byte> image_bytes) {
    const Cameras cameras = parse_binary_cameras(camera_bytes);
    ByteReader reader(image_bytes, "images.bin");
    std::vector<View> views;
    const std::uint64_t count = reader.read_count(LeastImageBytes);
    for (std::uint64_t i = 0; i < count; ++i) {
        reader.skip(4);  // image number
        std::array<double, 7> pose{};
        for (double& value : pose) value = reader.read<double>();
        const auto camera = reader.read<std::uint32_t>();
        const std::string_view name = reader.read_terminated();
        const std::uint64_t points = reader.read_count(PointBytes);
        reader.skip(points * PointBytes);
        views.push_back(make_view(name, pose, find_camera(cameras, camera)));
    }
    return sorted(std::move(views));
}

std::vector<View> parse_colmap_text(std::string_view camera_text, std::string_view image_text) {
    const Cameras cameras = parse_text_cameras(camera_text);
    std::vector<View> views;
    Lines lines(image_text);
    std::string_view line;
    while (lines.next(line)) {
        if (is_comment_or_blank(line)) continue;
        next_word(line);  // image number
        std::array<double, 7> pose{};
        for (double& value : pose) value = number<double>(next_word(line), "images.txt");
        const auto camera = number<std::uint32_t>(next_word(line), "images.txt");
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        views.push_back(make_view(line, pose, find_camera(cameras, camera)));  // names may hold blanks
        lines.next(line);  // the image's points; may be empty, so it must not be skipped as a blank line
    }
    return sorted(std::move(views));
}

}  // namespace gse
