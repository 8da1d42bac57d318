// Viewpoints for a scene that came without cameras: a circle that frames the robust bounds.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/scene/scene.h"

namespace gse {
namespace {

constexpr double SmallestRadius = 1e-3;  // world units, for splats without any size
// Radians between the lower and the upper ring, so that tops are seen.
constexpr double HighElevationStep = 0.35;
constexpr double SteepestElevation = 1.3;  // radians; straight down has no defined "right"
// Multiple of the half diagonal: the robust bounds leave 2 % of the splats outside.
constexpr double FramingMargin = 1.15;

}  // namespace

OrbitParameters fit_orbit(const SceneStatistics& statistics, const Vec3& up) {
    OrbitParameters orbit;
    orbit.centre = (statistics.robust_low + statistics.robust_high) * 0.5;
    if (length(up) > 0) orbit.up = normalized(up);
    const double half_diagonal = 0.5 * length(statistics.robust_high - statistics.robust_low);
    const double scene_radius = half_diagonal > 0 ? half_diagonal : statistics.count > 0 ? SmallestRadius : 1;
    // The sphere around the bounds touches the left and right edge of the image.
    orbit.radius = FramingMargin * scene_radius / std::sin(0.5 * orbit.fov_x);
    return orbit;
}

std::vector<View> orbit_views(const OrbitParameters& orbit, int count, int width, int height) {
    GSE_CHECK(count >= 0 && width > 0 && height > 0);
    std::vector<View> views;
    views.reserve(static_cast<std::size_t>(count));
    for (int index = 0; index < count; ++index) {
        OrbitParameters ring = orbit;
        if (index % 2 == 1) ring.elevation = std::min(SteepestElevation, orbit.elevation + HighElevationStep);
        const double azimuth = 2 * std::numbers::pi * index / count;
        views.push_back(
            {fmt::format("orbit_{:03}", index), orbit_camera(ring, azimuth, width, height), false});
    }
    return views;
}

}  // namespace gse
