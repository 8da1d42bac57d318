// Look-at and orbit cameras.
#include "engine/math/camera.h"

#include <cmath>

namespace gse {
namespace {

/// A unit vector at right angles to `axis`.
Vec3 any_perpendicular(const Vec3& axis) {
    const Vec3 helper = std::abs(axis.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(cross(axis, helper));
}

}  // namespace

Vec3 Camera::centre() const { return -(rotation.transposed() * translation); }

Camera Camera::resized(int new_width, int new_height) const {
    Camera result = *this;
    const double scale = static_cast<double>(new_width) / width;
    result.width = new_width;
    result.height = new_height;
    result.fx = fx * scale;
    result.fy = fy * scale;
    result.cx = cx * scale;
    result.cy = cy * scale + 0.5 * (new_height - height * scale);
    return result;
}

Camera Camera::look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double fov_x, int width,
                       int height) {
    Vec3 forward = normalized(target - eye);
    if (length(forward) == 0) forward = {0, 0, 1};
    Vec3 right = normalized(cross(forward, up));
    if (length(right) == 0) right = any_perpendicular(forward);
    const Vec3 down = cross(forward, right);
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = 0.5 * width / std::tan(0.5 * fov_x);
    camera.cx = 0.5 * width;
    camera.cy = 0.5 * height;
    camera.rotation = Mat3::from_columns(right, down, forward).transposed();
    camera.translation = -(camera.rotation * eye);
    return camera;
}

Camera orbit_camera(const OrbitParameters& orbit, double azimuth, int width, int height) {
    const Vec3 up = normalized(orbit.up);
    // The azimuth starts at the horizontal direction nearest to -z, so that "front" faces a camera at -z.
    Vec3 front = Vec3{0, 0, -1} - up * dot(up, Vec3{0, 0, -1});
    front = length(front) > 1e-6 ? normalized(front) : any_perpendicular(up);
    const Vec3 side = cross(up, front);
    const Vec3 flat = front * std::cos(azimuth) + side * std::sin(azimuth);
    const Vec3 eye =
        orbit.centre + (flat * std::cos(orbit.elevation) + up * std::sin(orbit.elevation)) * orbit.radius;
    return Camera::look_at(eye, orbit.centre, up, orbit.fov_x, width, height);
}

}  // namespace gse
