// Depths as the rasterizer composites them, divided by their weight.
#include "engine/pipeline/scene/shown_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/edit/placement/thing_bounds.h"
#include "engine/math/framing.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::pipeline {
namespace {

constexpr int WidestDepths = 288;     // pixels: places need no finer ones
constexpr float LeastCovered = 0.5f;  // alpha of a pixel that shows a surface

}  // namespace

Camera first_view(const Scene& scene, int width, int height) {
    const OrbitParameters orbit = scene_orbit(scene, RenderParameters{});
    const Bounds bounds = edit::thing_bounds(scene.gaussians, normalized(scene.info.up));
    return home_camera(orbit, bounds, RenderParameters{}.fov * Degree, width, height);
}

SeenSurface shown_surface(const GaussianSet& set, const Camera& camera, bool antialiased) {
    const double smaller = std::min(1.0, static_cast<double>(WidestDepths) / camera.width);
    const auto pixels = [&](int size) { return std::max(1, static_cast<int>(std::lround(size * smaller))); };
    SeenSurface surface{camera.resized(pixels(camera.width), pixels(camera.height)), {}};
    raster::Settings settings;
    settings.antialiased = antialiased;
    Painter painter;
    const auto& picture = painter.paint(set.spans(), surface.camera, settings);
    surface.depth = picture.depth;
    for (std::size_t pixel = 0; pixel < surface.depth.data.size(); ++pixel) {
        const float alpha = picture.alpha.data[pixel];
        surface.depth.data[pixel] = alpha >= LeastCovered ? surface.depth.data[pixel] / alpha : 0;
    }
    return surface;
}

double seen_share(const SeenSurface& surface, const GaussianSet& set) {
    constexpr std::size_t MostRows = 5000;
    const Camera& camera = surface.camera;
    std::size_t seen = 0, all = 0;
    for (std::size_t row = 0; row < set.size(); row += set.size() / MostRows + 1) {
        ++all;
        const auto p = set.position().subspan(row * 3, 3);
        const Vec3 at = camera.to_camera({p[0], p[1], p[2]});
        const double x = camera.fx * at.x / at.z + camera.cx, y = camera.fy * at.y / at.z + camera.cy;
        if (!(at.z > 0 && x >= 0 && y >= 0 && x < camera.width && y < camera.height)) continue;
        const double depth = surface.depth.at(static_cast<int>(x), static_cast<int>(y), 0);
        seen += !(depth > 0) || at.z <= depth ? 1 : 0;
    }
    return all == 0 ? 0 : static_cast<double>(seen) / static_cast<double>(all);
}

bool is_seen_from_around(const Scene& scene, const GaussianSet& put_in) {
    constexpr int Sides = 8;
    constexpr double MostOfIt = 0.6;  // low rows of what stands in grass or behind a step are hidden
    const OrbitParameters orbit = whole_orbit(scene, RenderParameters{});
    for (int side = 0; side < Sides; ++side) {
        const Camera camera =
            orbit_camera(orbit, 2 * std::numbers::pi * side / Sides, WidestDepths, WidestDepths);
        const auto surface = shown_surface(scene.gaussians, camera, scene.info.antialiased);
        if (seen_share(surface, put_in) >= MostOfIt) return true;
    }
    return false;
}

}  // namespace gse::pipeline
