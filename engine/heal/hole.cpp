// Rays over the chart, in eight pairs of opposite directions.
#include "engine/heal/hole.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gse::heal {
namespace {

constexpr int Orientations = 8;
// Orientations with cover on both sides, of a cell that is filled: where the thing was, and elsewhere.
constexpr int CoreOrientations = 2, LeastOrientations = 4;
constexpr int Passes = 4;              // each takes the cells filled before as covered
constexpr int SolidNeighbours = 3;     // known ones of the eight, of a cell that ends a ray
constexpr std::size_t LeastCells = 4;  // of a hole
constexpr double BorderWidth = 0.75;   // cells to either side of where two surfaces cut each other
constexpr double MostAligned = 0.9;    // cosine between the normals of surfaces that cut each other
constexpr double ShownShare = 0.6;     // of a hole, that other rows before it or close behind it cover
constexpr double BehindDepth = 0.12;   // of the thing's size
constexpr double BehindOpacity = 0.5;  // of rows behind it that are a surface
constexpr double FarSide = 0.3;        // cells beyond the cut, from which nothing is filled
constexpr std::uint8_t BeyondBorder = 2;
constexpr double BorderProbe = 1.5;  // cells above or below the cut, where the other surface must be

/// Signed distance of a point from a chart's surface; `found` tells whether it lies over the grid.
double distance_from(const Chart& chart, const Vec3& at, Vec3& local, bool& found) {
    local = chart.local(at);
    found = chart.height.inside(static_cast<int>(std::floor(local.x)), static_cast<int>(std::floor(local.y)));
    return found ? local.z - chart.height_at(local.x, local.y) : 0;
}

bool has(const BitGrid& bits, const Vec3& local) {
    const int x = static_cast<int>(std::floor(local.x)), y = static_cast<int>(std::floor(local.y));
    return bits.inside(x, y) && bits.at(x, y) != 0;
}

/// True when a ray from a cell meets a bit before it leaves the grid.
bool meets(const BitGrid& bits, int x, int y, double dx, double dy, double longest) {
    double px = x + 0.5 + dx, py = y + 0.5 + dy;
    for (double way = 1; way <= longest; way += 1, px += dx, py += dy) {
        const int cx = static_cast<int>(std::floor(px)), cy = static_cast<int>(std::floor(py));
        if (!bits.inside(cx, cy)) return false;
        if (bits.at(cx, cy) != 0) return true;
    }
    return false;
}

class Rays {
public:
    Rays(const BitGrid& ends, double longest) : ends_(ends), longest_(longest) {
        for (int k = 0; k < Orientations; ++k) {
            const double turn = std::numbers::pi * k / Orientations;
            step_[static_cast<std::size_t>(k)] = {std::cos(turn), std::sin(turn)};
        }
    }
    /// Number of orientations in which rays end on both sides.
    int bounded(int x, int y) const {
        int count = 0;
        for (const auto& step : step_)
            if (meets(ends_, x, y, step[0], step[1], longest_) &&
                meets(ends_, x, y, -step[0], -step[1], longest_))
                ++count;
        return count;
    }

private:
    const BitGrid& ends_;
    double longest_;
    std::array<std::array<double, 2>, Orientations> step_{};
};

/// Known cells with known ones around them, and borders.
BitGrid ends_of(const Chart& chart, const BitGrid& border) {
    BitGrid ends = border;
    each_cell(chart.known, [&](int x, int y) {
        if (chart.known.at(x, y) == 0) return;
        int around = 0;
        each_neighbour(chart.known, x, y, 1, [&](int nx, int ny) { around += chart.known.at(nx, ny); });
        if (around >= SolidNeighbours) ends.at(x, y) = 1;
    });
    return ends;
}

void drop_specks(BitGrid& cells) {
    std::vector<std::size_t> sizes;
    const auto groups = groups_of(cells, sizes);
    for (std::size_t i = 0; i < cells.cells.size(); ++i)
        if (cells.cells[i] != 0 && sizes[static_cast<std::size_t>(groups.cells[i])] < LeastCells)
            cells.cells[i] = 0;
}

/// Cells of a chart where another surface cuts it. Where the other one is hidden, it is taken to go on
/// between the places at which it is seen.
void add_border(const Chart& chart, const Chart& other, const BitGrid& other_near, BitGrid& border) {
    BitGrid seen(border.width, border.height, 0), perhaps = seen, far_side = seen;
    each_cell(border, [&](int x, int y) {
        const double h = chart.height.at(x, y);
        Vec3 local;
        bool found = false;
        const double away = distance_from(other, chart.world(x + 0.5, y + 0.5, h), local, found);
        if (!found || std::abs(away) > BorderWidth * chart.cell) return;
        const double probe = BorderProbe * chart.cell;
        const Vec3 above = other.local(chart.world(x + 0.5, y + 0.5, h + probe));
        const Vec3 below = other.local(chart.world(x + 0.5, y + 0.5, h - probe));
        if (has(other.known, above) || has(other.known, below)) seen.at(x, y) = 1;
        else if (has(other_near, above)) perhaps.at(x, y) = 1;
        far_side.at(x, y) = away < -FarSide * chart.cell ? 1 : 0;
    });
    const Vec3 along = normalized(cross(chart.normal, other.normal));
    const double dx = dot(along, chart.u), dy = dot(along, chart.v);
    const double longest = std::max(border.width, border.height);
    BitGrid wide = seen;
    each_cell(seen, [&](int x, int y) {
        if (seen.at(x, y) != 0) each_neighbour(seen, x, y, 1, [&](int nx, int ny) { wide.at(nx, ny) = 1; });
    });
    each_cell(border, [&](int x, int y) {
        if (seen.at(x, y) != 0 || (perhaps.at(x, y) != 0 && meets(wide, x, y, dx, dy, longest) &&
                                   meets(wide, x, y, -dx, -dy, longest)))
            border.at(x, y) =
                std::max<std::uint8_t>(border.at(x, y), far_side.at(x, y) != 0 ? BeyondBorder : 1);
    });
}

}  // namespace

BitGrid borders(std::span<const Chart> charts, std::span<const BitGrid> near, std::size_t which) {
    const Chart& chart = charts[which];
    BitGrid border(chart.height.width, chart.height.height, 0);
    for (std::size_t k = 0; k < charts.size(); ++k)
        if (k != which && std::abs(dot(charts[k].normal, chart.normal)) < MostAligned)
            add_border(chart, charts[k], near[k], border);
    return border;
}

void drop_shown(const Chart& chart, std::span<const SurfaceRow> rows, std::span<const std::uint8_t> removed,
                const Body& body, BitGrid& cells) {
    std::vector<double> heights;
    for (const auto& point : body.points) heights.push_back(chart.local(point).z);
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20);
    std::nth_element(heights.begin(), low, heights.end());
    const double first = std::max(3 * chart.cell, 1.5 * chart.tolerance);
    BitGrid before(cells.width, cells.height, 0), behind = before;
    for (const auto& row : rows) {
        if (removed[row.row] != 0) continue;
        const Vec3 at = chart.local(row.at);
        const double above = at.z - chart.height_at(at.x, at.y);
        if (above > first && above < *low + chart.cell)
            each_covered(chart, row, [&](std::size_t cell, double) { before.cells[cell] = 1; });
        if (above < -first && above > -BehindDepth * body.size)
            each_covered(chart, row, [&](std::size_t cell, double opacity) {
                if (opacity > BehindOpacity) behind.cells[cell] = 1;
            });
    }
    std::vector<std::size_t> sizes;
    const auto groups = groups_of(cells, sizes);
    std::vector<std::size_t> hidden(sizes.size(), 0), floored(sizes.size(), 0);
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        hidden[static_cast<std::size_t>(groups.cells[i])] += before.cells[i];
        floored[static_cast<std::size_t>(groups.cells[i])] += behind.cells[i];
    }
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        const auto group = static_cast<std::size_t>(groups.cells[i]);
        if (static_cast<double>(std::max(hidden[group], floored[group])) >
            ShownShare * static_cast<double>(sizes[group]))
            cells.cells[i] = 0;
    }
}

Grid<int> groups_of(const BitGrid& bits, std::vector<std::size_t>& sizes) {
    Grid<int> groups(bits.width, bits.height, 0);
    sizes.assign(1, 0);
    std::vector<std::size_t> open;
    const auto width = static_cast<std::size_t>(bits.width);
    for (std::size_t start = 0; start < bits.cells.size(); ++start) {
        if (bits.cells[start] == 0 || groups.cells[start] != 0) continue;
        const int group = static_cast<int>(sizes.size());
        sizes.push_back(0);
        groups.cells[start] = group;
        open.assign(1, start);
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            ++sizes.back();
            each_neighbour(bits, static_cast<int>(cell % width), static_cast<int>(cell / width), 1,
                           [&](int x, int y) {
                               const std::size_t next = bits.index(x, y);
                               if (bits.cells[next] == 0 || groups.cells[next] != 0) return;
                               groups.cells[next] = group;
                               open.push_back(next);
                           });
        }
    }
    return groups;
}

void drop_seams(BitGrid& cells, const BitGrid& foot) {
    BitGrid wide(cells.width, cells.height, 0);
    each_cell(cells, [&](int x, int y) {
        if (!cells.inside(x + 1, y + 1)) return;
        const bool block = cells.at(x, y) != 0 && cells.at(x + 1, y) != 0 && cells.at(x, y + 1) != 0 &&
                           cells.at(x + 1, y + 1) != 0;
        if (block) wide.at(x, y) = wide.at(x + 1, y) = wide.at(x, y + 1) = wide.at(x + 1, y + 1) = 1;
    });
    for (std::size_t i = 0; i < cells.cells.size(); ++i)
        if (wide.cells[i] == 0 && foot.cells[i] == 0) cells.cells[i] = 0;
}

Hole find_hole(const Chart& chart, const BitGrid& near, const BitGrid& core, const BitGrid& border) {
    Hole hole{BitGrid(chart.known.width, chart.known.height, 0)};
    BitGrid ends = ends_of(chart, border);
    BitGrid partly(chart.known.width, chart.known.height, 0);
    const double longest = std::max(chart.known.width, chart.known.height);
    for (int pass = 0; pass < Passes; ++pass) {
        const Rays rays(ends, longest);
        std::size_t found = 0;
        each_cell(near, [&](int x, int y) {
            if (near.at(x, y) == 0 || chart.known.at(x, y) != 0 || hole.cells.at(x, y) != 0) return;
            if (border.at(x, y) == BeyondBorder) return;
            const int bounded = rays.bounded(x, y);
            partly.at(x, y) = bounded > 0 ? 1 : 0;
            if (bounded >= (core.at(x, y) != 0 ? CoreOrientations : LeastOrientations))
                hole.cells.at(x, y) = 1, ++found;
        });
        if (found == 0) break;
        for (std::size_t i = 0; i < ends.cells.size(); ++i) ends.cells[i] |= hole.cells.cells[i];
    }
    drop_specks(hole.cells);
    for (std::size_t i = 0; i < partly.cells.size(); ++i)
        if (hole.cells.cells[i] != 0) partly.cells[i] = 0;
    drop_specks(partly);
    for (const auto bit : partly.cells) hole.open += bit;
    return hole;
}

}  // namespace gse::heal
