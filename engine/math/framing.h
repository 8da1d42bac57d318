// Boxes that a picture shows whole, and the cameras that see them.
#pragma once

#include <span>

#include "engine/math/camera.h"

namespace gse {

/// Box along the world's axes.
struct Bounds {
    Vec3 low{}, high{};

    Vec3 centre() const { return (low + high) * 0.5; }
    /// Radius of the ball around the box.
    double radius() const { return 0.5 * length(high - low); }
};

/// Distance from `target` at which a camera that looks at it sees all the points with a margin. `rotation` is
/// world to camera; `fov_x` is in radians. The picture may have any shape.
double fitting_distance(std::span<const Vec3> points, Vec3 target, const Mat3& rotation, double fov_x,
                        int width, int height);

/// Distance from the middle of the box at which a camera sees all of it with a margin. `rotation` is world to
/// camera; `fov_x` is in radians. The picture may have any shape.
double fitting_distance(const Bounds& bounds, const Mat3& rotation, double fov_x, int width, int height);

constexpr double HomeAzimuth = 0.5;  // radians

/// First camera of a scene: the direction of the orbit at HomeAzimuth, a little to the side of the front. The
/// picture shows the whole box.
Camera home_camera(const OrbitParameters& orbit, const Bounds& bounds, double fov_x, int width, int height);

}  // namespace gse
