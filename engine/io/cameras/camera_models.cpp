// Numbers of every COLMAP camera model, and models that are none of a lens.
#include "engine/io/cameras/camera_models.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/io/cameras/camera_checks.h"

namespace gse::io {
namespace {

/// Camera models; the index is COLMAP's model number.
constexpr std::array<ColmapModel, 18> Models = {{{"SIMPLE_PINHOLE", 3, 1, true},
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

/// Panoramas of nerfstudio, instant-ngp and the COLMAP forks for them.
constexpr std::array Panoramas = {
    "EQUIRECTANGULAR",         "SPHERICAL", "PANORAMA", "LATLONG", "OMNIDIRECTIONALSTEREO_L",
    "OMNIDIRECTIONALSTEREO_R", "VR180_L",   "VR180_R"};
constexpr std::array ParallelProjections = {"ORTHOPHOTO", "ORTHOGRAPHIC"};

constexpr std::size_t LongestModelName = 32;  // bytes, in a message
constexpr double LargestSide = LargestImageSide;

template <class List> bool has_name(const List& list, std::string_view name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

void refuse_without_lens(std::string_view model) {
    if (has_name(Panoramas, model))
        throw Error(
            ErrorCode::Unsupported,
            fmt::format("the camera model {} is that of panoramas, which have no focal length", model),
            "cut the panoramas into perspective pictures and use the cameras of those");
    if (has_name(ParallelProjections, model))
        throw Error(
            ErrorCode::Unsupported,
            fmt::format("the camera model {} is a parallel projection, which has no focal length", model),
            "use perspective pictures and their cameras");
}

const ColmapModel& colmap_model(std::int32_t number) {
    if (number < 0 || static_cast<std::size_t>(number) >= Models.size())
        throw Error(ErrorCode::Unsupported,
                    fmt::format("the COLMAP camera model number {} is not known", number),
                    "undistort the pictures with COLMAP, which gives PINHOLE cameras");
    return Models[static_cast<std::size_t>(number)];
}

const ColmapModel& colmap_model(std::string_view name) {
    const auto* model =
        std::find_if(Models.begin(), Models.end(), [&](const ColmapModel& m) { return m.name == name; });
    if (model != Models.end()) return *model;
    refuse_without_lens(name);
    throw Error(ErrorCode::Unsupported,
                fmt::format("the COLMAP camera model \"{}\" is not known", name.substr(0, LongestModelName)),
                "undistort the pictures with COLMAP, which gives PINHOLE cameras");
}

Intrinsics colmap_intrinsics(const ColmapModel& model, double width, double height,
                             std::span<const double> params) {
    if (!(width >= 1 && width <= LargestSide && height >= 1 && height <= LargestSide))
        throw Error(ErrorCode::Malformed, fmt::format("the image size is {} x {}", width, height));
    Intrinsics result;
    Camera& camera = result.camera;
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    if (model.focals == 0) {
        // A panorama has no pinhole; a quarter of it (90 degrees) is shown from its place.
        camera.fx = camera.fy = 0.5 * camera.height;
        camera.cx = 0.5 * width;
        camera.cy = 0.5 * height;
        result.distorted = result.panorama = true;
        return result;
    }
    camera.fx = params[0];
    camera.fy = params[model.focals - 1];
    camera.cx = params[model.focals];
    camera.cy = params[model.focals + 1];
    const auto extra = params.subspan(model.focals + 2);
    result.distorted = !model.perspective ||
                       std::any_of(extra.begin(), extra.end(), [](double value) { return value != 0; });
    check_camera(camera);
    return result;
}

}  // namespace gse::io
