// Pinhole camera. OpenCV axes (right, down, forward), world to camera. The first pixel's centre is at (0.5,
// 0.5).
#pragma once

#include "engine/math/vec.h"

namespace gse {

/// Camera with p_camera = rotation * p_world + translation and pixel = (fx x/z + cx, fy y/z + cy).
struct Camera {
    int width = 0;
    int height = 0;
    double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
    Mat3 rotation = Mat3::identity();       // world -> camera
    Vec3 translation{};                     // camera frame

    bool operator==(const Camera&) const = default;
    /// Camera centre in the world: -R^T t.
    Vec3 centre() const;
    Vec3 to_camera(const Vec3& world) const { return rotation * world + translation; }
    /// Unit viewing direction in the world.
    Vec3 forward() const { return rotation.row(2); }

    /// This view at another image size. The field of view in x keeps its relation to the width.
    Camera resized(int new_width, int new_height) const;

    /// Camera at `eye` looking at `target`; `up` is the world's up direction. fov_x in radians.
    static Camera look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double fov_x, int width,
                          int height);
};

/// Circle of cameras around a centre.
struct OrbitParameters {
    Vec3 centre{};
    Vec3 up{0, -1, 0};  // world up (COLMAP worlds have -y up)
    double radius = 1;
    double elevation = 0.35;  // radians above the horizon
    double fov_x = 0.87;      // radians
};

/// Camera on the orbit at `azimuth` radians.
Camera orbit_camera(const OrbitParameters& orbit, double azimuth, int width, int height);

}  // namespace gse
