// Views from the poses of images and the intrinsics of their cameras.
#include "engine/io/cameras/colmap_views.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/io/cameras/camera_checks.h"

namespace gse::io {
namespace {

const Intrinsics& intrinsics_of(const ColmapCameras& cameras, std::uint32_t id) {
    const auto found = cameras.find(id);
    if (found == cameras.end())
        throw Error(ErrorCode::Malformed, fmt::format("the COLMAP model has no camera {}", id));
    if (const auto* failure = std::get_if<Error>(&found->second)) throw *failure;
    return std::get<Intrinsics>(found->second);
}

Camera placed(Camera camera, const std::array<double, 7>& pose) {
    if (!std::all_of(pose.begin(), pose.end(), [](double value) { return std::isfinite(value); }))
        throw Error(ErrorCode::Malformed, "the rotation or position is not a finite number");
    const Quat q{pose[0], pose[1], pose[2], pose[3]};
    if (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z == 0)
        throw Error(ErrorCode::Malformed, "the rotation is a quaternion of zeros");
    camera.rotation = rotation_matrix(q);
    camera.translation = {pose[4], pose[5], pose[6]};
    check_camera(camera);
    return camera;
}

}  // namespace

void ColmapViews::add(std::string_view name, const std::array<double, 7>& pose, std::uint32_t camera) {
    try {
        const Intrinsics& intrinsics = intrinsics_of(cameras_, camera);
        views_.push_back({std::string(name), placed(intrinsics.camera, pose), intrinsics.distorted});
        if (intrinsics.panorama) panoramas_.add(quoted(name));
    } catch (const Error& error) { left_out_.add(quoted(name), error); }
}

CameraList ColmapViews::finish() {
    std::stable_sort(views_.begin(), views_.end(),
                     [](const View& a, const View& b) { return a.name < b.name; });
    std::vector<std::string> notes;
    if (panoramas_.size() > 0)
        notes.push_back(
            fmt::format("{} {} of the camera model EQUIRECTANGULAR, panoramas without a focal "
                        "length; they serve as viewpoints of 90 degrees",
                        panoramas_.text(), panoramas_.size() == 1 ? "is" : "are"));
    return left_out_.finish(std::move(views_), std::move(notes),
                            Error(ErrorCode::Malformed, "the COLMAP model has no images",
                                  "the file is damaged or not from COLMAP"));
}

}  // namespace gse::io
