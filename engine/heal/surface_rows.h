// Gaussians near a thing as pieces of surfaces, and the body that the thing fills.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::heal {

/// One Gaussian as a piece of a surface.
struct SurfaceRow {
    std::uint32_t row = 0;  // of the scene
    Vec3 at;                // world
    Vec3 normal;            // shortest axis; its sign means nothing
    Vec3 colour;            // base colour, not clamped
    std::array<Vec3, 3> axis;
    std::array<double, 3> scale{};  // standard deviations along the axes, world units
    double opacity = 0;
    double weight = 0;    // opacity times area, world units squared
    double flatness = 0;  // 0 = round, 1 = flat

    /// Standard deviation along the longest axis.
    double longest() const { return std::max({scale[0], scale[1], scale[2]}); }
};

/// Rows of the set that can be drawn, are visible, and that `wanted` takes. Ascending.
std::vector<SurfaceRow> surface_rows(const GaussianSet& set, std::span<const std::uint8_t> usable,
                                     const std::function<bool(std::size_t, const Vec3&)>& wanted);

/// Space that a thing fills: points of it, and the box of most of them.
struct Body {
    std::vector<Vec3> points;
    Vec3 low, high;
    double size = 0;    // diagonal of the box
    double weight = 0;  // sum over the rows
    bool empty() const { return points.empty() || !(size > 0); }
    /// True for places in the box grown by `margin` on all sides.
    bool near(const Vec3& at, double margin) const;
};

/// Body of a thing's rows. A few stray rows do not widen its box.
Body body_of(std::span<const SurfaceRow> thing);

/// Body of a ball.
Body ball_body(const Vec3& centre, double radius);

}  // namespace gse::heal
