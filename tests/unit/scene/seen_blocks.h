// Surfaces of boxes as a camera sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/scene/transform/seen_place.h"

namespace gse::test {

/// Box of a room, seen from outside of it.
struct Block {
    Vec3 low, high;
};

/// Distance along a ray to the block; infinite where it misses.
inline double hit(const Block& block, const Vec3& from, const Vec3& ray) {
    double enters = 0, leaves = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (block.low[axis] - from[axis]) / ray[axis],
                     b = (block.high[axis] - from[axis]) / ray[axis];
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
    }
    return enters < leaves ? enters : std::numeric_limits<double>::infinity();
}

/// The nearest surface of the blocks in every pixel.
inline SeenSurface seen(const std::vector<Block>& blocks, const Vec3& eye, const Vec3& target,
                        const Vec3& up = {0, 1, 0}) {
    constexpr int Width = 160, Height = 90;
    SeenSurface surface{Camera::look_at(eye, target, up, 0.9, Width, Height), Image(Width, Height, 1)};
    const Camera& camera = surface.camera;
    for (int y = 0; y < Height; ++y)
        for (int x = 0; x < Width; ++x) {
            const Vec3 ray = camera.rotation.transposed() *
                             Vec3{(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1};
            double depth = std::numeric_limits<double>::infinity();
            for (const auto& block : blocks) depth = std::min(depth, hit(block, eye, ray));
            surface.depth.at(x, y, 0) = std::isfinite(depth) ? static_cast<float>(depth) : 0;
        }
    return surface;
}

}  // namespace gse::test
