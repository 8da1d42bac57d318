// One supporting surface around a thing as a picture: a grid over its plane, with heights, colours and cover.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/heal/grid.h"
#include "engine/heal/surface_rows.h"

namespace gse::heal {

/// Plane with its normal on the thing's side.
struct Plane {
    Vec3 origin, normal;
    double height(const Vec3& at) const { return dot(at - origin, normal); }
};

/// Grid over a plane. Places on it are in cells: cell (x, y) spans [x, x + 1) by [y, y + 1). Heights over the
/// plane are in world units.
struct Chart {
    Vec3 origin;  // world place of (0, 0) at height 0
    Vec3 u, v, normal;
    double cell = 0;                        // side of a cell, world units
    double tolerance = 0;                   // rows this far from the surface still belong to it, world units
    Grid<double> height;                    // of the surface
    BitGrid seen;                           // cells whose height comes from rows
    Grid<double> through;                   // share of light that passes all own rows, in [0,1]
    Grid<Vec3> colour;                      // from straight above
    BitGrid known;                          // cells that own rows cover
    double usual_cover = 0;                 // median over the cells with own rows
    std::vector<std::uint32_t> own;         // indices of the surface's rows, ascending
    std::vector<float> shown;               // [rows] share of an own row that shows from straight above
    std::vector<std::uint32_t> cell_first;  // [cells + 1] where a cell begins in `cell_rows`
    std::vector<std::uint32_t> cell_rows;   // indices of own rows by the cell that holds their middle

    /// Place of a point: x and y in cells, z its height over the plane.
    Vec3 local(const Vec3& world) const;
    Vec3 world(double x, double y, double height) const;
    /// Height of the surface at a place, bilinear.
    double height_at(double x, double y) const;
    /// Unit normal of the surface at a place.
    Vec3 normal_at(double x, double y) const;
    std::span<const std::uint32_t> rows_in(int x, int y) const;
};

/// Value between the middles of cells, bilinear; the border goes on beyond the grid.
template <class T> T between_cells(const Grid<T>& grid, double x, double y) {
    x = std::clamp(x - 0.5, 0.0, grid.width - 1.0), y = std::clamp(y - 0.5, 0.0, grid.height - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, grid.width - 1), y1 = std::min(y0 + 1, grid.height - 1);
    const double s = x - x0, t = y - y0;
    return (grid.at(x0, y0) * (1 - s) + grid.at(x1, y0) * s) * (1 - t) +
           (grid.at(x0, y1) * (1 - s) + grid.at(x1, y1) * s) * t;
}

/// Chart of the surface that goes on from the plane, over slopes and slow curves. Rows with taken[index] != 0
/// belong to another surface. None where too few rows lie on it.
std::optional<Chart> make_chart(std::span<const SurfaceRow> rows, std::span<const std::uint8_t> taken,
                                const Plane& plane, double tolerance, const Body& body, const Vec3& up);

/// Draws own rows from straight above again: `through`, `colour`, `known` and the rows by cell.
void draw_chart(Chart& chart, std::span<const SurfaceRow> rows);

/// Ellipse of a Gaussian on a chart.
struct Footprint {
    double x = 0, y = 0;              // middle, cells
    double a = 0, b = 0, c = 0;       // inverse covariance: a dx^2 + 2 b dx dy + c dy^2
    double reach_x = 0, reach_y = 0;  // cells that it covers to either side
    double at(double px, double py) const;
};
Footprint footprint(const Chart& chart, const SurfaceRow& row);

/// Calls call(index, opacity) for the cells that the row covers.
template <class F> void each_covered(const Chart& chart, const SurfaceRow& row, F&& call) {
    const Footprint print = footprint(chart, row);
    const int x0 = std::max(0, static_cast<int>(std::floor(print.x - print.reach_x)));
    const int x1 = std::min(chart.height.width - 1, static_cast<int>(std::floor(print.x + print.reach_x)));
    const int y0 = std::max(0, static_cast<int>(std::floor(print.y - print.reach_y)));
    const int y1 = std::min(chart.height.height - 1, static_cast<int>(std::floor(print.y + print.reach_y)));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double opacity = row.opacity * print.at(x + 0.5, y + 0.5);
            if (opacity > 1.0 / 255) call(chart.height.index(x, y), std::min(opacity, 0.99));
        }
}

}  // namespace gse::heal
