// Boxes and grids around the source of an edit, in a frame that knows what is up and where the front is.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "engine/edit/placement/voxel_region.h"

namespace gse::edit {

constexpr double BoundsTrim = 0.01;  // share of the rows cut off at either end of every axis

/// Right-handed frame of the scene: x sideways (to the right of who looks at the front), y up, z to the
/// front.
struct Frame {
    Vec3 side, up, front;
    Vec3 to_frame(const Vec3& p) const { return {dot(p, side), dot(p, up), dot(p, front)}; }
    Vec3 to_world(const Vec3& p) const { return side * p.x + up * p.y + front * p.z; }
};

Frame make_frame(const Vec3& up_direction, const Vec3& front_direction);

/// Visible rows in frame coordinates: those of the source, or all others.
std::vector<Vec3> visible_points(const RegionSearch& search, const Frame& frame, bool of_source);

struct Box {
    Vec3 low, high;
    Vec3 size() const { return high - low; }
    Vec3 centre() const { return (low + high) * 0.5; }
    bool has(const Vec3& p) const;
};

/// The value that `share` of all are below; `values` must not be empty.
double quantile(std::vector<double> values, double share);

/// Bounds of the points without the `trim` outermost share at either end of every axis.
Box trimmed_box(const std::vector<Vec3>& points, double trim);

/// Cells of a box, x fastest.
struct Grid {
    Box box;
    double side = 0;
    std::array<int, 3> count{};
    std::size_t size() const {
        return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
               static_cast<std::size_t>(count[2]);
    }
    Vec3 centre(std::size_t cell) const;
};

/// `cells` along the longest side of the box.
Grid make_grid(const Box& box, int cells);

/// The cells whose centres are inside.
VoxelRegion fill(const Frame& frame, const Grid& grid, const std::function<bool(const Vec3&)>& inside);

}  // namespace gse::edit
