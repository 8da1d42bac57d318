// Distances at which a camera sees all of a box.
#include "engine/math/framing.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gse {
namespace {

constexpr double FilledShare = 0.9;  // of the picture's width and height, by a box that is to be seen whole
// Share of the box's distance from the origin, so that a point has a camera beside it.
constexpr double SmallestBox = 1e-9;

}  // namespace

double fitting_distance(std::span<const Vec3> points, Vec3 target, const Mat3& rotation, double fov_x,
                        int width, int height) {
    const double across = FilledShare * std::tan(0.5 * fov_x), down = across * height / width;
    double distance = 0;
    for (const Vec3& at : points) {
        const Vec3 p = rotation * (at - target);
        distance = std::max({distance, std::abs(p.x) / across - p.z, std::abs(p.y) / down - p.z});
    }
    const double least = SmallestBox * length(target);
    return std::max(distance, least > 0 ? least : SmallestBox);
}

double fitting_distance(const Bounds& bounds, const Mat3& rotation, double fov_x, int width, int height) {
    std::array<Vec3, 8> corners;
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
        corners[corner] = {corner & 1 ? bounds.high.x : bounds.low.x,
                           corner & 2 ? bounds.high.y : bounds.low.y,
                           corner & 4 ? bounds.high.z : bounds.low.z};
    return fitting_distance(corners, bounds.centre(), rotation, fov_x, width, height);
}

Camera home_camera(const OrbitParameters& orbit, const Bounds& bounds, double fov_x, int width, int height) {
    const Mat3 rotation = orbit_camera(orbit, HomeAzimuth, width, height).rotation;
    const Vec3 forward = rotation.row(2);
    const double distance = fitting_distance(bounds, rotation, fov_x, width, height);
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = 0.5 * width / std::tan(0.5 * fov_x);
    camera.cx = 0.5 * width;
    camera.cy = 0.5 * height;
    camera.rotation = rotation;
    camera.translation = -(rotation * (bounds.centre() - forward * distance));
    return camera;
}

}  // namespace gse
