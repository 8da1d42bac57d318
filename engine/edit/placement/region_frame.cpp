// Frame, bounds and grid of a region search.
#include "engine/edit/placement/region_frame.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/math/quantile.h"

namespace gse::edit {
namespace {

constexpr float InvisibleLogit = -5.5373f;  // opacity 1/255

std::vector<double> axis_values(const std::vector<Vec3>& points, int axis) {
    std::vector<double> values;
    for (const auto& point : points) values.push_back(point[axis]);
    return values;
}

}  // namespace

Frame make_frame(const Vec3& up_direction, const Vec3& front_direction) {
    Frame frame;
    frame.up = normalized(up_direction);
    frame.front = front_direction - frame.up * dot(front_direction, frame.up);
    if (length(frame.front) < 1e-6) {
        const Vec3 helper = std::abs(frame.up.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        frame.front = cross(frame.up, helper);
    }
    frame.front = normalized(frame.front);
    frame.side = cross(frame.up, frame.front);
    return frame;
}

std::vector<Vec3> visible_points(const RegionSearch& search, const Frame& frame, bool of_source) {
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < search.gaussians.size(); ++row) {
        const auto p = search.gaussians.position().subspan(row * 3, 3);
        const bool finite = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
        if ((search.source_bits[row] != 0) == of_source && finite &&
            search.gaussians.opacity_logit()[row] > InvisibleLogit)
            points.push_back(frame.to_frame({p[0], p[1], p[2]}));
    }
    return points;
}

bool Box::has(const Vec3& p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
}

double quantile(std::vector<double> values, double share) { return nearest_quantile(values, share); }

Box trimmed_box(const std::vector<Vec3>& points, double trim) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto values = axis_values(points, axis);
        box.low[axis] = quantile(values, trim);
        box.high[axis] = quantile(values, 1 - trim);
    }
    return box;
}

Vec3 Grid::centre(std::size_t cell) const {
    const auto nx = static_cast<std::size_t>(count[0]), ny = static_cast<std::size_t>(count[1]);
    const Vec3 index{static_cast<double>(cell % nx), static_cast<double>(cell / nx % ny),
                     static_cast<double>(cell / (nx * ny))};
    return box.low + (index + Vec3{0.5, 0.5, 0.5}) * side;
}

Grid make_grid(const Box& box, int cells) {
    Grid grid;
    grid.box = box;
    const Vec3 size = box.size();
    grid.side = std::max({size.x, size.y, size.z, 1e-9}) / std::max(cells, 1);
    for (int axis = 0; axis < 3; ++axis)
        grid.count[static_cast<std::size_t>(axis)] =
            std::max(1, static_cast<int>(std::ceil(size[axis] / grid.side)));
    return grid;
}

VoxelRegion fill(const Frame& frame, const Grid& grid, const std::function<bool(const Vec3&)>& inside) {
    VoxelRegion region;
    region.side = grid.side;
    for (std::size_t cell = 0; cell < grid.size(); ++cell)
        if (inside(grid.centre(cell))) region.centres.push_back(frame.to_world(grid.centre(cell)));
    return region;
}

}  // namespace gse::edit
