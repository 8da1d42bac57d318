// Limits of sizes, lenses and poses.
#include "engine/io/cameras/camera_checks.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"

namespace gse::io {
namespace {

constexpr double RotationTolerance = 0.01;  // files hold rotations with few digits

bool has_size(const Camera& camera) {
    return camera.width >= 1 && camera.height >= 1 && camera.width <= LargestImageSide &&
           camera.height <= LargestImageSide;
}

bool has_lens(const Camera& camera) {
    return std::isfinite(camera.fx) && std::isfinite(camera.fy) && camera.fx > 0 && camera.fy > 0 &&
           std::isfinite(camera.cx) && std::isfinite(camera.cy);
}

bool is_finite(const Camera& camera) {
    const Vec3& t = camera.translation;
    bool finite = std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z);
    for (const double entry : camera.rotation.rows()) finite = finite && std::isfinite(entry);
    return finite;
}

bool is_orthonormal(const Mat3& rotation) {
    bool valid = true;
    const Mat3 product = rotation * rotation.transposed();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            valid = valid && std::abs(product(row, column) - (row == column ? 1 : 0)) < RotationTolerance;
    return valid;
}

double determinant(const Mat3& m) { return dot(cross(m.columns[0], m.columns[1]), m.columns[2]); }

[[noreturn]] void throw_bad_camera(const std::string& what, const char* hint) {
    throw Error(ErrorCode::Malformed, what, hint);
}

}  // namespace

void check_intrinsics(const Camera& camera, const std::string& which, const char* hint) {
    if (!has_size(camera))
        throw_bad_camera(
            fmt::format("the camera {} has an image size of {} x {}", which, camera.width, camera.height),
            hint);
    if (!has_lens(camera))
        throw_bad_camera(fmt::format("the camera {} has focal lengths {} and {} and centre ({}, {})", which,
                                     camera.fx, camera.fy, camera.cx, camera.cy),
                         hint);
}

void check_pose(const Camera& camera, const std::string& which, const char* hint) {
    if (!is_finite(camera) || !is_orthonormal(camera.rotation))
        throw_bad_camera(fmt::format("the camera \"{}\" has no valid rotation and position", which), hint);
}

void check_camera(const Camera& camera) {
    if (!has_size(camera))
        throw_bad_camera(fmt::format("the image size is {} x {}", camera.width, camera.height), "");
    if (!has_lens(camera))
        throw_bad_camera(fmt::format("the focal lengths are {} and {} and the centre is ({}, {})", camera.fx,
                                     camera.fy, camera.cx, camera.cy),
                         "export it with focal lengths above zero");
    if (!is_finite(camera)) throw_bad_camera("the rotation or position is not a finite number", "");
    if (!is_orthonormal(camera.rotation)) throw_bad_camera("the rotation is not a rotation matrix", "");
    if (determinant(camera.rotation) < 0)
        throw_bad_camera("the rotation is mirrored (determinant -1), and so would be the picture",
                         "export it again as a rotation, with determinant 1");
}

}  // namespace gse::io
