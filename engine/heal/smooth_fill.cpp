// Successive over-relaxation, begun from what spreads inwards; quadrics by reweighted least squares.
#include "engine/heal/smooth_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/heal/hole.h"

namespace gse::heal {
namespace {

constexpr int FourSides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
constexpr int MostSweeps = 240;

/// Means of the neighbours that have a value, ring by ring; returns the cells in that order.
template <class T>
std::vector<std::size_t> spread_inwards(Grid<T>& values, const BitGrid& fill, const BitGrid& fixed,
                                        int& rings) {
    BitGrid done = fixed;
    std::vector<std::size_t> order, ring, next;
    BitGrid queued(fill.width, fill.height, 0);
    const auto width = static_cast<std::size_t>(fill.width);
    const auto queue_around = [&](int x, int y) {
        for (const auto& side : FourSides) {
            const int nx = x + side[0], ny = y + side[1];
            if (!fill.inside(nx, ny) || fill.at(nx, ny) == 0 || fixed.at(nx, ny) != 0) continue;
            if (queued.at(nx, ny) == 0) queued.at(nx, ny) = 1, next.push_back(fill.index(nx, ny));
        }
    };
    each_cell(fixed, [&](int x, int y) {
        if (fixed.at(x, y) != 0) queue_around(x, y);
    });
    for (rings = 0; !next.empty(); ++rings) {
        ring.swap(next);
        next.clear();
        for (const auto cell : ring) {
            const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
            T sum{};
            double count = 0;
            each_neighbour(done, x, y, 1, [&](int nx, int ny) {
                if (done.at(nx, ny) != 0) sum += values.at(nx, ny), count += 1;
            });
            if (count > 0) values.cells[cell] = sum / count;
        }
        for (const auto cell : ring) {
            done.cells[cell] = 1;
            order.push_back(cell);
            queue_around(static_cast<int>(cell % width), static_cast<int>(cell / width));
        }
    }
    return order;
}

template <class T> void membrane(Grid<T>& values, const BitGrid& fill, const BitGrid& fixed) {
    int rings = 0;
    const auto order = spread_inwards(values, fill, fixed, rings);
    BitGrid part = fixed;
    for (const auto cell : order) part.cells[cell] = 1;
    const double relax = 2 / (1 + std::sin(std::numbers::pi / (2.0 * rings + 2)));
    const int sweeps = std::min(MostSweeps, 6 * rings + 8);
    const auto width = static_cast<std::size_t>(fill.width);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (const auto cell : order) {
            const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
            T sum{};
            double count = 0;
            for (const auto& side : FourSides) {
                const int nx = x + side[0], ny = y + side[1];
                if (part.inside(nx, ny) && part.at(nx, ny) != 0) sum += values.at(nx, ny), count += 1;
            }
            if (count > 0) values.cells[cell] += (sum / count - values.cells[cell]) * relax;
        }
}

constexpr std::size_t Terms = 6;
using Quadric = std::array<double, Terms>;

Quadric terms_at(double x, double y) { return {1, x, y, x * x, x * y, y * y}; }

double value_of(const Quadric& quadric, double x, double y) {
    const auto terms = terms_at(x, y);
    double sum = 0;
    for (std::size_t i = 0; i < Terms; ++i) sum += quadric[i] * terms[i];
    return sum;
}

/// Solves the normal equations by Gaussian elimination; they are positive definite.
Quadric solved(std::array<std::array<double, Terms + 1>, Terms> m) {
    for (std::size_t k = 0; k < Terms; ++k)
        for (std::size_t r = k + 1; r < Terms; ++r) {
            const double factor = m[r][k] / m[k][k];
            for (std::size_t c = k; c <= Terms; ++c) m[r][c] -= factor * m[k][c];
        }
    Quadric result{};
    for (std::size_t k = Terms; k-- > 0;) {
        double sum = m[k][Terms];
        for (std::size_t c = k + 1; c < Terms; ++c) sum -= m[k][c] * result[c];
        result[k] = sum / m[k][k];
    }
    return result;
}

struct RimPoint {
    double x, y, height, weight;
};

/// Quadric through the points; outliers count little. `scale`: a usual deviation.
Quadric fitted(std::span<const RimPoint> points, double scale) {
    constexpr int FitRounds = 5;
    constexpr double Bend = 0.02;  // of the weight, that holds curvature back
    Quadric quadric{};
    for (int round = 0; round < FitRounds; ++round) {
        std::array<std::array<double, Terms + 1>, Terms> m{};
        double total = 1e-12;
        for (const auto& point : points) {
            const double off = round == 0 ? 0 : (value_of(quadric, point.x, point.y) - point.height) / scale;
            const double w = point.weight / (1 + off * off);
            const auto terms = terms_at(point.x, point.y);
            total += w;
            for (std::size_t r = 0; r < Terms; ++r) {
                for (std::size_t c = 0; c < Terms; ++c) m[r][c] += w * terms[r] * terms[c];
                m[r][Terms] += w * terms[r] * point.height;
            }
        }
        for (std::size_t k = 0; k < Terms; ++k) m[k][k] += total * (k < 3 ? 1e-9 : Bend * Bend);
        quadric = solved(m);
    }
    return quadric;
}

/// Frame of a quadric around one hole: its middle and half its width, in cells.
struct Around {
    double x = 0, y = 0, radius = 1;
};

Around around(const Grid<int>& groups, int group) {
    int x0 = groups.width, x1 = -1, y0 = groups.height, y1 = -1;
    each_cell(groups, [&](int x, int y) {
        if (groups.at(x, y) != group) return;
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    });
    return {0.5 * (x0 + x1 + 1), 0.5 * (y0 + y1 + 1), 0.5 * std::max({x1 - x0 + 1, y1 - y0 + 1, 2})};
}

/// Fits one hole and sets its heights, and those of its rim to what the quadric leaves in `rest`.
void fit_hole(Chart& chart, const Grid<int>& groups, int group, const Grid<double>& away, Grid<double>& rest,
              const Grid<double>& before) {
    const Around frame = around(groups, group);
    const double band = std::max(5.0, 0.9 * frame.radius);
    std::vector<RimPoint> points;
    each_cell(before, [&](int x, int y) {
        if (chart.seen.at(x, y) == 0 || groups.at(x, y) != 0 || away.at(x, y) > band) return;
        if (std::max(std::abs(x - frame.x), std::abs(y - frame.y)) > frame.radius + band) return;
        const double d = 2 * away.at(x, y) / band;
        points.push_back({(x + 0.5 - frame.x) / frame.radius, (y + 0.5 - frame.y) / frame.radius,
                          before.at(x, y), 1 / (1 + d * d)});
    });
    const auto quadric = points.empty() ? Quadric{} : fitted(points, 0.5 * chart.tolerance);
    each_cell(before, [&](int x, int y) {
        const bool in_hole = groups.at(x, y) == group;
        if (!in_hole && !(chart.seen.at(x, y) != 0 && groups.at(x, y) == 0 && away.at(x, y) < 2)) return;
        const double px = (x + 0.5 - frame.x) / frame.radius, py = (y + 0.5 - frame.y) / frame.radius;
        if (std::max(std::abs(px), std::abs(py)) > 1 + 3 / frame.radius) return;
        const double value = value_of(quadric, px, py);
        if (in_hole) chart.height.at(x, y) = value;
        else rest.at(x, y) = before.at(x, y) - value;
    });
}

}  // namespace

void fill_membrane(Grid<double>& values, const BitGrid& fill, const BitGrid& fixed) {
    membrane(values, fill, fixed);
}

void fill_membrane(Grid<Vec3>& values, const BitGrid& fill, const BitGrid& fixed) {
    membrane(values, fill, fixed);
}

void fill_heights(Chart& chart, const BitGrid& hole) {
    std::vector<std::size_t> sizes;
    const auto groups = groups_of(hole, sizes);
    const auto away = distance_to(hole);
    const auto before = chart.height;
    Grid<double> rest(hole.width, hole.height, 0);
    for (int group = 1; group < static_cast<int>(sizes.size()); ++group)
        fit_hole(chart, groups, group, away, rest, before);
    BitGrid rim(hole.width, hole.height, 0);
    for (std::size_t i = 0; i < rim.cells.size(); ++i)
        rim.cells[i] = hole.cells[i] == 0 && chart.seen.cells[i] != 0 && away.cells[i] < 2 ? 1 : 0;
    membrane(rest, hole, rim);
    BitGrid set = chart.seen, unset(hole.width, hole.height, 0);
    for (std::size_t i = 0; i < rim.cells.size(); ++i) {
        if (hole.cells[i] != 0) chart.height.cells[i] += rest.cells[i], set.cells[i] = 1;
        unset.cells[i] = set.cells[i] == 0 ? 1 : 0;
    }
    int rings = 0;
    spread_inwards(chart.height, unset, set, rings);
}

}  // namespace gse::heal
