// Even sampling of a list of shapes: area tables per shape, a low-discrepancy sequence, removal of hidden
// points.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/laboratory/synth/objects/shapes.h"

namespace gse::synth {
namespace {

constexpr double EdgeMargin = 0.5;  // times the spacing: distance of a disc from a sharp edge
constexpr int Columns = 24;         // along u; a multiple of 6, the faces of a box
constexpr int Rows = 14;            // along v

/// Area of the cells of a grid over (u, v), as cumulative sums, so that uniform numbers become points of even
/// density.
struct AreaTable {
    std::array<double, Rows + 1> rows{};                          // cumulative over rows
    std::array<std::array<double, Columns + 1>, Rows> columns{};  // cumulative within a row
    double area() const { return rows[Rows]; }
};

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * length(cross(b - a, c - a));
}

/// Position only; for a box the corner belongs to the face left of it when `end` is set.
Vec3 grid_point(const Shape& shape, int column, int row, bool end) {
    const double u = static_cast<double>(column) / Columns - (end ? 1e-9 : 0);
    return shape.at(u, static_cast<double>(row) / Rows).position;
}

AreaTable area_table(const Shape& shape) {
    AreaTable table;
    const bool faces = shape.kind == Shape::Kind::Cube;
    std::array<Vec3, Columns + 1> low{}, high{}, low_end{}, high_end{};
    const auto fill = [&](std::array<Vec3, Columns + 1>& start, std::array<Vec3, Columns + 1>& finish,
                          int row) {
        for (int c = 0; c <= Columns; ++c) {
            const auto i = static_cast<std::size_t>(c);
            start[i] = grid_point(shape, c, row, false);
            finish[i] = faces ? grid_point(shape, c, row, true) : start[i];
        }
    };
    fill(low, low_end, 0);
    for (std::size_t row = 0; row < Rows; ++row) {
        fill(high, high_end, static_cast<int>(row) + 1);
        auto& sums = table.columns[row];
        for (std::size_t c = 0; c < Columns; ++c)
            sums[c + 1] = sums[c] + triangle_area(low[c], low_end[c + 1], high[c]) +
                          triangle_area(high_end[c + 1], high[c], low_end[c + 1]);
        table.rows[row + 1] = table.rows[row] + sums[Columns];
        std::swap(low, high);
        std::swap(low_end, high_end);
    }
    return table;
}

/// Parameter in [0,1] at which the cumulative sums reach `fraction` of their total, and the cell it lies in.
template <std::size_t Size>
double invert(const std::array<double, Size>& sums, double fraction, std::size_t& cell) {
    const double wanted = fraction * sums.back();
    const auto above = std::upper_bound(sums.begin() + 1, sums.end() - 1, wanted);
    cell = static_cast<std::size_t>(above - sums.begin()) - 1;
    const double width = sums[cell + 1] - sums[cell];
    const double t = width > 0 ? std::clamp((wanted - sums[cell]) / width, 0.0, 1.0) : 0.5;
    return (static_cast<double>(cell) + t) / static_cast<double>(Size - 1);
}

SurfacePoint table_point(const Shape& shape, const AreaTable& table, double a, double b, double margin) {
    std::size_t row = 0;
    std::size_t column = 0;
    double v = invert(table.rows, a, row);
    double u = invert(table.columns[row], b, column);
    shape.keep_from_edges(u, v, margin);
    return shape.at(u, v);
}

/// The R2 sequence (Roberts 2018): evenly spread for every count.
struct Sequence {
    double a, b;
    explicit Sequence(Random& random) : a(random.uniform()), b(random.uniform()) {}
    void step() {
        a += 0.7548776662466927;
        b += 0.5698402909980532;
        a -= std::floor(a);
        b -= std::floor(b);
    }
};

struct Solid {
    const Shape* shape;
    double radius2;
};

bool hidden(const Vec3& point, const Shape* own, std::span<const Solid> solids) {
    if (point.y < -1e-3) return true;
    return std::any_of(solids.begin(), solids.end(), [&](const Solid& solid) {
        const Vec3 offset = point - solid.shape->centre;
        return solid.shape != own && dot(offset, offset) < solid.radius2 && solid.shape->contains(point);
    });
}

std::vector<Solid> solids_of(std::span<const Shape> shapes, std::span<const Shape> others) {
    std::vector<Solid> solids;
    for (const auto& list : {shapes, others})
        for (const auto& shape : list) {
            const double radius = shape.bounding_radius();
            if (shape.solid && shape.kind != Shape::Kind::Sheet) solids.push_back({&shape, radius * radius});
        }
    return solids;
}

}  // namespace

std::vector<SurfacePoint> sample_surface(std::span<const Shape> shapes, std::span<const Shape> others,
                                         int target, Random random) {
    constexpr int Probes = 40;  // per shape, to estimate how much of it can be seen
    const auto solids = solids_of(shapes, others);
    std::vector<AreaTable> tables;
    tables.reserve(shapes.size());
    double weighted_area = 0;
    for (const auto& shape : shapes) {
        tables.push_back(area_table(shape));
        Sequence sequence(random);
        int seen = 0;
        for (int i = 0; i < Probes; ++i, sequence.step())
            seen +=
                hidden(table_point(shape, tables.back(), sequence.a, sequence.b, 0).position, &shape, solids)
                    ? 0
                    : 1;
        weighted_area += tables.back().area() * shape.density * seen / Probes;
    }
    const double cell = weighted_area / std::max(target, 1);  // area per point at density 1
    std::vector<SurfacePoint> points;
    points.reserve(static_cast<std::size_t>(std::max(target, 1)) * 5 / 4);
    for (std::size_t s = 0; s < shapes.size() && cell > 0; ++s) {
        const int count = std::max(3, static_cast<int>(tables[s].area() * shapes[s].density / cell + 0.5));
        const double spacing = std::sqrt(tables[s].area() / count);
        Sequence sequence(random);
        for (int i = 0; i < count; ++i, sequence.step()) {
            SurfacePoint point =
                table_point(shapes[s], tables[s], sequence.a, sequence.b, EdgeMargin * spacing);
            if (hidden(point.position, &shapes[s], solids)) continue;
            point.spacing = spacing;
            point.shape = static_cast<std::uint32_t>(s);
            points.push_back(point);
        }
    }
    return points;
}

}  // namespace gse::synth
