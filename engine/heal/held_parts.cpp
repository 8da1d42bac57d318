// Connected components over a grid of cells of space.
#include "engine/heal/held_parts.h"
#include "engine/math/quantile.h"

#include <algorithm>
#include <cmath>

namespace gse::heal {
namespace {

constexpr double Cells = 44;          // along the diagonal of the thing
constexpr double SplatReach = 1.5;    // standard deviations of a row that fill cells
constexpr int MostProbes = 24;        // along an axis of a row
constexpr int Touch = 2;              // cells between a part and the thing that it hangs on
constexpr double LowCells = 2.5;      // cells above the thing's foot that count as its ground
constexpr double CrumbShare = 0.01;   // of the thing's weight: such a part goes even near the ground
constexpr int CloseCells = 5;         // cells from the thing that are its close surroundings
constexpr double CloseShare = 0.9;    // of a remnant's cells that lie there
constexpr double RemnantShare = 0.1;  // of the thing's weight, that a remnant has at most
constexpr double FootShare = 0.02;    // of the thing's points that may lie below its foot

class Space {
public:
    Space(const Body& body, double margin) {
        side_ = body.size / Cells;
        low_ = body.low - Vec3(margin);
        for (int k = 0; k < 3; ++k)
            size_[k] = static_cast<int>(std::ceil((body.high[k] - body.low[k] + 2 * margin) / side_)) + 1;
        cells_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                          static_cast<std::size_t>(size_[2]),
                      0);
    }
    double side() const { return side_; }
    std::size_t count() const { return cells_.size(); }
    std::uint8_t& operator[](std::size_t cell) { return cells_[cell]; }
    static constexpr std::size_t Nowhere = ~std::size_t{0};

    std::size_t find(const Vec3& at) const {
        int c[3];
        for (int k = 0; k < 3; ++k) {
            c[k] = static_cast<int>(std::floor((at[k] - low_[k]) / side_));
            if (c[k] < 0 || c[k] >= size_[k]) return Nowhere;
        }
        return index(c[0], c[1], c[2]);
    }
    /// Calls call(cell) for the cells that a row fills.
    template <class F> void each_filled(const SurfaceRow& row, F&& call) const {
        std::array<std::size_t, 3> by_size{0, 1, 2};
        std::sort(by_size.begin(), by_size.end(),
                  [&](std::size_t a, std::size_t b) { return row.scale[a] > row.scale[b]; });
        const auto probes = [&](std::size_t axis) {
            return std::min(MostProbes, static_cast<int>(std::ceil(SplatReach * row.scale[axis] / side_)));
        };
        const int along = probes(by_size[0]), across = probes(by_size[1]);
        for (int a = -along; a <= along; ++a)
            for (int b = -across; b <= across; ++b) {
                const double s = along > 0 ? SplatReach * a / along : 0;
                const double t = across > 0 ? SplatReach * b / across : 0;
                if (s * s + t * t > SplatReach * SplatReach * 1.01) continue;
                const Vec3 at = row.at + row.axis[by_size[0]] * (s * row.scale[by_size[0]]) +
                                row.axis[by_size[1]] * (t * row.scale[by_size[1]]);
                if (const std::size_t cell = find(at); cell != Nowhere) call(cell);
            }
    }
    /// Calls call(cell) for the cells at most `reach` away along each axis; `border` tells of an end of
    /// space.
    template <class F> void each_around(std::size_t cell, int reach, bool& border, F&& call) const {
        const auto w = static_cast<std::size_t>(size_[2]), h = static_cast<std::size_t>(size_[1]);
        const int z = static_cast<int>(cell % w), y = static_cast<int>(cell / w % h);
        const int x = static_cast<int>(cell / w / h);
        for (int dx = -reach; dx <= reach; ++dx)
            for (int dy = -reach; dy <= reach; ++dy)
                for (int dz = -reach; dz <= reach; ++dz) {
                    const int a = x + dx, b = y + dy, c = z + dz;
                    if (a < 0 || b < 0 || c < 0 || a >= size_[0] || b >= size_[1] || c >= size_[2])
                        border = true;
                    else call(index(a, b, c));
                }
    }

private:
    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size_[2]) +
               static_cast<std::size_t>(z);
    }
    double side_ = 0;
    Vec3 low_;
    int size_[3] = {0, 0, 0};
    std::vector<std::uint8_t> cells_;
};

enum : std::uint8_t { RestBit = 1, ThingBit = 2 };

struct Part {
    double weight = 0, lowest = 1e30;
    bool touches = false, goes_on = false;
};

/// Numbers of the parts by cell, from 1.
std::vector<int> parts_of(Space& space, std::vector<Part>& parts) {
    std::vector<int> part(space.count(), 0);
    std::vector<std::size_t> open;
    parts.assign(1, {});
    for (std::size_t start = 0; start < space.count(); ++start) {
        if ((space[start] & RestBit) == 0 || part[start] != 0) continue;
        const int number = static_cast<int>(parts.size());
        parts.emplace_back();
        part[start] = number;
        open.assign(1, start);
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            space.each_around(cell, 1, parts.back().goes_on, [&](std::size_t next) {
                if ((space[next] & RestBit) == 0 || part[next] != 0) return;
                part[next] = number;
                open.push_back(next);
            });
            bool border = false;
            if (!parts.back().touches)
                space.each_around(cell, Touch, border, [&](std::size_t next) {
                    parts.back().touches = parts.back().touches || (space[next] & ThingBit) != 0;
                });
        }
    }
    return part;
}

/// Height of the thing's lowest points, but for a few.
double foot_of(const Body& body, const Vec3& up) {
    std::vector<double> heights;
    for (const auto& point : body.points) heights.push_back(dot(point, up));
    return lower_quantile(heights, FootShare);
}

/// Parts of some rows in the space around a thing.
struct Parts {
    Space space;
    std::vector<Part> parts;
    std::vector<int> of_cell;

    Parts(std::span<const SurfaceRow> thing, std::span<const SurfaceRow> rest, const Body& body,
          double margin)
        : space(body, margin) {
        for (const auto& row : thing)
            space.each_filled(row, [&](std::size_t cell) { space[cell] |= ThingBit; });
        for (const auto& row : rest)
            space.each_filled(row, [&](std::size_t cell) { space[cell] |= RestBit; });
        of_cell = parts_of(space, parts);
    }
    std::size_t number(const SurfaceRow& row) const {
        const std::size_t cell = space.find(row.at);
        return cell == Space::Nowhere ? std::size_t{0} : static_cast<std::size_t>(of_cell[cell]);
    }
};

}  // namespace

std::vector<std::uint8_t> held_parts(std::span<const SurfaceRow> thing, std::span<const SurfaceRow> rest,
                                     const Body& body, double margin, const Vec3& up) {
    std::vector<std::uint8_t> held(rest.size(), 0);
    Parts all(thing, rest, body, margin);
    for (const auto& row : rest) {
        Part& one = all.parts[all.number(row)];
        one.weight += row.weight;
        one.lowest = std::min(one.lowest, dot(row.at, up));
    }
    const double ground = foot_of(body, up) + LowCells * all.space.side();
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const std::size_t which = all.number(rest[i]);
        if (which == 0) continue;
        const Part& one = all.parts[which];
        if (!one.touches || one.goes_on || one.weight > body.weight) continue;
        if (one.lowest > ground || one.weight < CrumbShare * body.weight) held[i] = 1;
    }
    return held;
}

std::vector<std::uint8_t> remnants(std::span<const SurfaceRow> thing, std::span<const SurfaceRow> loose,
                                   const Body& body, double margin) {
    Parts all(thing, loose, body, margin);
    std::vector<std::size_t> cells(all.parts.size(), 0), close(all.parts.size(), 0);
    for (std::size_t cell = 0; cell < all.of_cell.size(); ++cell) {
        const auto which = static_cast<std::size_t>(all.of_cell[cell]);
        if (which == 0 || !all.parts[which].touches || all.parts[which].goes_on) continue;
        bool border = false, near = false;
        all.space.each_around(cell, CloseCells, border,
                              [&](std::size_t other) { near = near || (all.space[other] & ThingBit) != 0; });
        ++cells[which];
        close[which] += near ? 1U : 0U;
    }
    for (const auto& row : loose) all.parts[all.number(row)].weight += row.weight;
    std::vector<std::uint8_t> left(loose.size(), 0);
    for (std::size_t i = 0; i < loose.size(); ++i) {
        const std::size_t which = all.number(loose[i]);
        const Part& one = all.parts[which];
        if (which == 0 || !one.touches || one.goes_on || one.weight > RemnantShare * body.weight) continue;
        if (static_cast<double>(close[which]) >= CloseShare * static_cast<double>(cells[which])) left[i] = 1;
    }
    return left;
}

}  // namespace gse::heal
