// The body's low points on the chart, closed and filled.
#include "engine/heal/foot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/heal/distance.h"

namespace gse::heal {
namespace {

constexpr double ContactShare = 0.05;  // of the thing's size: height of points that stand on a surface
constexpr double RemainShare = 0.08;   // height of remains over the surface, and depth below it
constexpr double LargestRemain = 0.2;  // of the thing's size, standard deviation
constexpr int ClosingCells = 2;
constexpr std::size_t LeastFoot = 4;             // cells
constexpr int NearestRing = 3, WidestRing = 30;  // cells around the foot whose colours are compared
constexpr std::size_t MostRing = 1500;
constexpr std::array Lights{1.0, 1.25, 1.6, 2.0};  // factors by which a shaded colour may be too dark
constexpr double Unlike = 0.15;                    // distance of a colour from all colours around
constexpr double GarbageShare = 0.25;              // of the foot's known cells

BitGrid shrunk(const BitGrid& bits, int cells) {
    BitGrid inverse = bits;
    for (auto& bit : inverse.cells) bit = bit != 0 ? 0 : 1;
    inverse = grown(inverse, cells);
    for (auto& bit : inverse.cells) bit = bit != 0 ? 0 : 1;
    return inverse;
}

/// Sets the cells that no path of cells without a bit joins to the grid's border.
void fill_enclosed(BitGrid& bits) {
    BitGrid outside(bits.width, bits.height, 0);
    std::vector<std::size_t> open;
    const auto width = static_cast<std::size_t>(bits.width);
    const auto visit = [&](int x, int y) {
        if (!bits.inside(x, y) || bits.at(x, y) != 0 || outside.at(x, y) != 0) return;
        outside.at(x, y) = 1;
        open.push_back(bits.index(x, y));
    };
    each_cell(bits, [&](int x, int y) {
        if (x == 0 || y == 0 || x == bits.width - 1 || y == bits.height - 1) visit(x, y);
    });
    while (!open.empty()) {
        const int x = static_cast<int>(open.back() % width), y = static_cast<int>(open.back() / width);
        open.pop_back();
        visit(x + 1, y), visit(x - 1, y), visit(x, y + 1), visit(x, y - 1);
    }
    for (std::size_t i = 0; i < bits.cells.size(); ++i) bits.cells[i] = outside.cells[i] != 0 ? 0 : 1;
}

}  // namespace

BitGrid grown(const BitGrid& bits, int cells) {
    const auto away = distance_to(bits);
    BitGrid result = bits;
    for (std::size_t i = 0; i < bits.cells.size(); ++i)
        result.cells[i] = away.cells[i] <= cells + 0.5 ? 1 : 0;
    return result;
}

BitGrid foot_cells(const Chart& chart, const Body& body) {
    BitGrid foot(chart.height.width, chart.height.height, 0);
    for (const auto& point : body.points) {
        const Vec3 at = chart.local(point);
        const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
        if (foot.inside(x, y) && std::abs(at.z - chart.height.at(x, y)) < ContactShare * body.size)
            foot.at(x, y) = 1;
    }
    foot = shrunk(grown(foot, ClosingCells), ClosingCells);
    fill_enclosed(foot);
    std::size_t count = 0;
    for (const auto bit : foot.cells) count += bit;
    if (count < LeastFoot) foot = BitGrid(foot.width, foot.height, 0);
    return foot;
}

bool foot_is_garbage(const Chart& chart, const BitGrid& foot) {
    const auto away = distance_to(foot);
    std::vector<Vec3> around, ring;
    for (std::size_t i = 0; i < foot.cells.size(); ++i)
        if (chart.known.cells[i] != 0 && away.cells[i] >= NearestRing && away.cells[i] <= WidestRing)
            around.push_back(chart.colour.cells[i]);
    const std::size_t count = std::min(MostRing, around.size());
    for (std::size_t k = 0; k < count; ++k) ring.push_back(around[k * around.size() / count]);
    if (ring.empty()) return false;
    std::size_t known = 0, unlike = 0;
    for (std::size_t i = 0; i < foot.cells.size(); ++i) {
        if (foot.cells[i] == 0 || chart.known.cells[i] == 0) continue;
        double least = FarAway;
        for (const double light : Lights)
            for (const auto& colour : ring) {
                const Vec3 d = chart.colour.cells[i] * light - colour;
                least = std::min(least, dot(d, d));
            }
        ++known;
        if (least > Unlike * Unlike) ++unlike;
    }
    return static_cast<double>(unlike) > GarbageShare * static_cast<double>(known);
}

void each_remain(const Chart& chart, const BitGrid& foot, std::span<const SurfaceRow> rows,
                 std::span<const std::uint8_t> taken, const Body& body, bool below,
                 const std::function<void(std::size_t)>& call) {
    const double reach = RemainShare * body.size;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (taken[i] != 0 || rows[i].longest() > LargestRemain * body.size) continue;
        const Vec3 at = chart.local(rows[i].at);
        const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
        if (!foot.inside(x, y) || foot.at(x, y) == 0) continue;
        const double rise = at.z - chart.height.at(x, y);
        if (rise < reach && rise > (below ? -reach : 0.0)) call(i);
    }
}

}  // namespace gse::heal
