// Boxes that are to be seen whole, and the cameras that see them.
#pragma once

#include <span>

#include "engine/math/camera.h"

namespace gse {

/// A box along the world's axes.
struct Bounds {
    Vec3 low{}, high{};

    Vec3 centre() const { return (low + high) * 0.5; }
    /// Radius of the ball around the box.
    double radius() const { return 0.5 * length(high - low); }
};

/// How far from `target` a camera of this rotation (world -> camera) that looks at it sees all the points,
/// with a margin, in a picture of any shape that is fov_x (radians) wide.
double fitting_distance(std::span<const Vec3> points, Vec3 target, const Mat3& rotation, double fov_x,
                        int width, int height);

/// How far from the middle of the box a camera of this rotation (world -> camera) sees all of it, with a
/// margin, in a picture of any shape that is fov_x (radians) wide.
double fitting_distance(const Bounds& bounds, const Mat3& rotation, double fov_x, int width, int height);

constexpr double HomeAzimuth = 0.5;  // radians

/// Where a scene is first seen from: the direction of the orbit at HomeAzimuth, a little to the side of its
/// front, all of the box in the picture.
Camera home_camera(const OrbitParameters& orbit, const Bounds& bounds, double fov_x, int width, int height);

}  // namespace gse
