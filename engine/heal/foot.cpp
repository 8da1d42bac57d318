// The body's low points on the chart, closed and filled.
#include "engine/heal/foot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/heal/distance.h"
#include "engine/math/quantile.h"

namespace gse::heal {
namespace {

constexpr double ContactShare = 0.05;  // of the thing's size: height of points that stand on a surface
constexpr double RemainShare = 0.08;   // height of remains over the surface, and depth below it
constexpr double LargestRemain = 0.2;  // of the thing's size, standard deviation
constexpr int ClosingCells = 2;
constexpr std::size_t LeastFoot = 4;             // cells
constexpr int NearestRing = 3, WidestRing = 16;  // cells around the foot whose colours are compared
constexpr double AroundCells = 3.5;              // from a hole, that must show the surface
constexpr std::size_t MostRing = 1500;
constexpr std::array Lights{1.0, 1.25, 1.6, 2.0};  // factors by which a shaded colour may be too dark
constexpr double Unlike = 0.15;                    // distance of a colour from all colours around
constexpr double GarbageShare = 0.25;              // of the foot's known cells
constexpr double LeastKnown = 0.3;                 // of the foot's cells, that there is a surface to judge
constexpr double LeastDensity = 0.7;  // of rows in the foot over those around; above its inverse, too
constexpr double LargestSize = 1.5;   // of the rows in the foot over those around; below its inverse, too
constexpr double LeastDetail = 0.85;  // of density times squared size, for a foot that is as whole as the
                                      // surface around but finer; below its inverse, too
constexpr double LeastLightFine = 0.28, MostHueFine = 0.12;  // of such a foot
constexpr double LeastLight = 0.45, MostLight = 1.1;         // of the foot over that around
constexpr double MostHue = 0.06;                             // difference of the channels' shares

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

/// Means over some known cells of a surface.
struct Look {
    std::size_t cells = 0;
    double density = 0;  // rows in a cell
    double size = 0;     // median standard deviation of the rows, along their longest axis
    double light = 0;    // sum of the channels
    Vec3 share;          // of the channels in it
};

template <class F> Look look_of(const Chart& chart, std::span<const SurfaceRow> rows, F&& wanted) {
    Look look;
    Vec3 sum;
    std::vector<double> sizes;
    each_cell(chart.known, [&](int x, int y) {
        const std::size_t cell = chart.known.index(x, y);
        if (chart.known.cells[cell] == 0 || !wanted(cell)) return;
        ++look.cells;
        sum += chart.colour.cells[cell];
        for (const auto i : chart.rows_in(x, y)) sizes.push_back(rows[i].longest());
    });
    if (sizes.empty()) return {};
    look.size = upper_median(sizes);
    look.density = static_cast<double>(sizes.size()) / static_cast<double>(look.cells);
    look.light = std::max(1e-3, (sum.x + sum.y + sum.z) / static_cast<double>(look.cells));
    look.share = sum / std::max(1e-3, sum.x + sum.y + sum.z);
    return look;
}

/// Share of the foot's known cells with a colour that occurs nowhere in the ring, lit or shaded.
template <class F> double unlike_share(const Chart& chart, const BitGrid& foot, F&& in_ring) {
    std::vector<Vec3> around, ring;
    for (std::size_t i = 0; i < foot.cells.size(); ++i)
        if (chart.known.cells[i] != 0 && in_ring(i)) around.push_back(chart.colour.cells[i]);
    const std::size_t count = std::min(MostRing, around.size());
    for (std::size_t k = 0; k < count; ++k) ring.push_back(around[k * around.size() / count]);
    double known = 0, unlike = 0;
    for (std::size_t i = 0; i < foot.cells.size(); ++i) {
        if (foot.cells[i] == 0 || chart.known.cells[i] == 0) continue;
        double least = FarAway;
        for (const double light : Lights)
            for (const auto& colour : ring) {
                const Vec3 d = chart.colour.cells[i] * light - colour;
                least = std::min(least, dot(d, d));
            }
        known += 1;
        if (least > Unlike * Unlike) unlike += 1;
    }
    return unlike / std::max(known, 1.0);
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

bool foot_is_garbage(const Chart& chart, const BitGrid& foot, std::span<const SurfaceRow> rows) {
    const auto away = distance_to(foot);
    const auto in_ring = [&](std::size_t i) {
        return away.cells[i] >= NearestRing && away.cells[i] <= WidestRing;
    };
    const Look under = look_of(chart, rows, [&](std::size_t i) { return foot.cells[i] != 0; });
    const Look around = look_of(chart, rows, in_ring);
    const auto cells = static_cast<double>(std::count(foot.cells.begin(), foot.cells.end(), 1));
    if (static_cast<double>(under.cells) < LeastKnown * cells || around.cells == 0) return false;
    const double density = under.density / around.density, light = under.light / around.light;
    const double hue = length(under.share - around.share);
    const double detail = density * under.size * under.size / (around.size * around.size);
    const bool fine = under.size < around.size && detail > LeastDetail && detail < 1 / LeastDetail;
    if (fine && light > LeastLightFine && light < MostLight && hue < MostHueFine)
        return unlike_share(chart, foot, in_ring) > GarbageShare;
    if (density < LeastDensity || density > 1 / LeastDensity) return true;
    if (under.size > LargestSize * around.size || under.size * LargestSize < around.size) return true;
    if (light < LeastLight || light > MostLight) return true;
    if (hue > MostHue) return true;
    return unlike_share(chart, foot, in_ring) > GarbageShare;
}

double known_around(const Chart& chart, const BitGrid& bits, const BitGrid& border) {
    const auto away = distance_to(bits);
    double known = 0, all = 0;
    for (std::size_t i = 0; i < bits.cells.size(); ++i) {
        if (bits.cells[i] != 0 || away.cells[i] > AroundCells) continue;
        all += 1;
        if (chart.known.cells[i] != 0 || border.cells[i] != 0) known += 1;
    }
    return all > 0 ? known / all : 0;
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
