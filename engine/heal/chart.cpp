// A surface grows from the rows on its plane, cell by cell; then it is drawn from above.
#include "engine/heal/chart.h"
#include "engine/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace gse::heal {
namespace {

constexpr std::size_t LeastRows = 24;      // of a surface
constexpr double Aligned = 0.45;           // cosine between the normals of a row and its surface
constexpr double RoundRow = 0.3;           // flatness below which a normal means nothing
constexpr double MarginShare = 0.9;        // of the thing's size, that a chart shows around it
constexpr double DeepestShare = 0.5;       // of the thing's size, that a surface leaves its plane
constexpr double LargestGrid = 280;        // cells a side
constexpr double FinestShare = 1.0 / 240;  // of the thing's size: least side of a cell
constexpr double CoarsestShare = 1.0 / 7;  // largest
constexpr double SteepStep = 1.3;          // cells by which the surface rises from cell to cell at most
constexpr double UsualCoverShare = 0.72;   // of the median cover, above which a cell is known
constexpr double LeastCover = 0.25;        // of a cell that counts for that median
constexpr int Smoothings = 2;              // of the heights, over the cells around
constexpr double LowPass = 0.3;            // cells, standard deviation that is added to every row
constexpr double LongestReach = 24;        // cells, drawn of a row

bool lies_along(const SurfaceRow& row, const Vec3& normal) {
    return row.flatness < RoundRow || std::abs(dot(row.normal, normal)) > Aligned;
}

/// Distance between neighbouring rows on the plane: from the area that the four nearest of a row share.
double spacing_of(std::span<const Vec3> places) {
    constexpr std::size_t MostAsked = 300, LeastAsked = 20, Nearest = 4, MostWork = 6'000'000;
    std::vector<double> spacing, squared(places.size());
    const std::size_t asked = std::clamp(MostWork / places.size(), LeastAsked, MostAsked);
    const std::size_t count = std::min(asked, places.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3& at = places[i * places.size() / count];
        for (std::size_t k = 0; k < places.size(); ++k) squared[k] = dot(places[k] - at, places[k] - at);
        const auto far = squared.begin() + Nearest;
        std::nth_element(squared.begin(), far, squared.end());
        spacing.push_back(std::sqrt(*far * 3.14159265358979 / Nearest));
    }
    return upper_median(spacing);
}

class Builder {
public:
    Builder(std::span<const SurfaceRow> rows, std::span<const std::uint8_t> taken, const Plane& plane,
            const Body& body)
        : rows_(rows), taken_(taken), plane_(plane), body_(body) {}

    std::optional<Chart> build(double tolerance, const Vec3& up) {
        chart_.normal = plane_.normal;
        const Vec3 other = std::abs(dot(up, plane_.normal)) < 0.9 ? up
                           : std::abs(plane_.normal.x) < 0.6      ? Vec3{1, 0, 0}
                                                                  : Vec3{0, 0, 1};
        chart_.u = normalized(cross(other, plane_.normal));
        chart_.v = cross(plane_.normal, chart_.u);
        chart_.tolerance = tolerance;
        if (!place_grid()) return std::nullopt;
        sort_into_cells();
        grow();
        choose_own();
        if (chart_.own.size() < LeastRows) return std::nullopt;
        smooth();
        draw_chart(chart_, rows_);
        return std::move(chart_);
    }

private:
    /// Cells about as wide as the rows lie apart, over everything around the thing.
    bool place_grid() {
        std::vector<Vec3> on_plane;
        Vec3 low{FarLength}, high{-FarLength};
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const double h = plane_.height(rows_[i].at);
            if (taken_[i] != 0 || std::abs(h) > DeepestShare * body_.size) continue;
            const Vec3 at{dot(rows_[i].at, chart_.u), dot(rows_[i].at, chart_.v), 0};
            low = {std::min(low.x, at.x), std::min(low.y, at.y), 0};
            high = {std::max(high.x, at.x), std::max(high.y, at.y), 0};
            if (std::abs(h) <= chart_.tolerance && lies_along(rows_[i], plane_.normal))
                on_plane.push_back(at);
        }
        if (on_plane.size() < LeastRows) return false;
        chart_.cell = std::clamp(spacing_of(on_plane), body_.size * FinestShare, body_.size * CoarsestShare);
        const double margin = MarginShare * body_.size;
        Vec3 body_low{FarLength}, body_high{-FarLength};
        for (const auto& point : body_.points) {
            const Vec3 at{dot(point, chart_.u), dot(point, chart_.v), 0};
            body_low = {std::min(body_low.x, at.x), std::min(body_low.y, at.y), 0};
            body_high = {std::max(body_high.x, at.x), std::max(body_high.y, at.y), 0};
        }
        double extent[2];
        for (int k = 0; k < 2; ++k) {
            low[k] = std::max(low[k], body_low[k] - margin);
            high[k] = std::min(high[k], body_high[k] + margin);
            extent[k] = high[k] - low[k];
            if (!(extent[k] > 0)) return false;
        }
        chart_.cell = std::max(chart_.cell, std::max(extent[0], extent[1]) / LargestGrid);
        low -= Vec3{2 * chart_.cell, 2 * chart_.cell, 0};
        const int columns = static_cast<int>(std::ceil(extent[0] / chart_.cell)) + 4;
        const int lines = static_cast<int>(std::ceil(extent[1] / chart_.cell)) + 4;
        chart_.origin =
            chart_.u * low.x + chart_.v * low.y + plane_.normal * dot(plane_.origin, plane_.normal);
        chart_.height = Grid<double>(columns, lines, 0);
        chart_.seen = BitGrid(columns, lines, 0);
        return true;
    }

    /// Heights of the rows of every cell that may belong to the surface.
    void sort_into_cells() {
        const std::size_t cells = chart_.height.cells.size();
        first_.assign(cells + 1, 0);
        place_.assign(rows_.size(), NoCell);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (taken_[i] != 0 || !lies_along(rows_[i], plane_.normal)) continue;
            const Vec3 at = chart_.local(rows_[i].at);
            const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
            if (!chart_.height.inside(x, y) || std::abs(at.z) > DeepestShare * body_.size) continue;
            place_[i] = static_cast<std::uint32_t>(chart_.height.index(x, y));
            ++first_[place_[i] + 1];
        }
        for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
        heights_.resize(first_[cells]);
        auto next = first_;
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (place_[i] != NoCell) heights_[next[place_[i]]++] = chart_.local(rows_[i].at).z;
    }

    /// Sets the height of a cell to the median of its rows near `expected`. False without such rows.
    bool settle(std::size_t cell, double expected, double reach) {
        few_.clear();
        for (std::uint32_t k = first_[cell]; k < first_[cell + 1]; ++k)
            if (std::abs(heights_[k] - expected) <= reach) few_.push_back(heights_[k]);
        if (few_.empty()) return false;
        chart_.height.cells[cell] = upper_median(few_);
        chart_.seen.cells[cell] = 1;
        return true;
    }

    /// Spreads from the cells with rows on the plane to those around, over gaps of one cell.
    void grow() {
        std::queue<std::size_t> open;
        for (std::size_t cell = 0; cell < chart_.height.cells.size(); ++cell)
            if (settle(cell, 0, chart_.tolerance)) open.push(cell);
        const auto width = static_cast<std::size_t>(chart_.height.width);
        while (!open.empty()) {
            const std::size_t cell = open.front();
            open.pop();
            const int x = static_cast<int>(cell % width), y = static_cast<int>(cell / width);
            each_neighbour(chart_.height, x, y, 2, [&](int nx, int ny) {
                const std::size_t next = chart_.height.index(nx, ny);
                if (chart_.seen.cells[next] != 0) return;
                const double step = SteepStep * chart_.cell * std::hypot(nx - x, ny - y);
                if (settle(next, chart_.height.cells[cell], std::max(step, 0.5 * chart_.tolerance)))
                    open.push(next);
            });
        }
    }

    void choose_own() {
        const double reach = std::max(chart_.tolerance, chart_.cell);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (place_[i] == NoCell || chart_.seen.cells[place_[i]] == 0) continue;
            if (std::abs(chart_.local(rows_[i].at).z - chart_.height.cells[place_[i]]) <= reach)
                chart_.own.push_back(static_cast<std::uint32_t>(i));
        }
    }

    /// Means of the heights over pairs of opposite neighbours, so that a slope stays as it is at a rim.
    void smooth() {
        constexpr int Pairs[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
        for (int pass = 0; pass < Smoothings; ++pass) {
            const auto before = chart_.height;
            const auto seen = [&](int x, int y) { return before.inside(x, y) && chart_.seen.at(x, y) != 0; };
            each_cell(before, [&](int x, int y) {
                if (!seen(x, y)) return;
                double sum = before.at(x, y), count = 1;
                for (const auto& [dx, dy] : Pairs)
                    if (seen(x + dx, y + dy) && seen(x - dx, y - dy))
                        sum += before.at(x + dx, y + dy) + before.at(x - dx, y - dy), count += 2;
                chart_.height.at(x, y) = sum / count;
            });
        }
    }

    static constexpr std::uint32_t NoCell = ~std::uint32_t{0};
    static constexpr double FarLength = 1e30;
    std::span<const SurfaceRow> rows_;
    std::span<const std::uint8_t> taken_;
    const Plane& plane_;
    const Body& body_;
    Chart chart_;
    std::vector<std::uint32_t> first_, place_;  // of the cells in `heights_`; cell of a row
    std::vector<double> heights_, few_;
};

}  // namespace

Vec3 Chart::local(const Vec3& world) const {
    const Vec3 d = world - origin;
    return {dot(d, u) / cell, dot(d, v) / cell, dot(d, normal)};
}

Vec3 Chart::world(double x, double y, double h) const {
    return origin + u * (x * cell) + v * (y * cell) + normal * h;
}

double Chart::height_at(double x, double y) const { return between_cells(height, x, y); }

Vec3 Chart::normal_at(double x, double y) const {
    const double du = (height_at(x + 1, y) - height_at(x - 1, y)) / (2 * cell);
    const double dv = (height_at(x, y + 1) - height_at(x, y - 1)) / (2 * cell);
    return normalized(normal - u * du - v * dv);
}

std::span<const std::uint32_t> Chart::rows_in(int x, int y) const {
    const std::size_t at = height.index(x, y);
    return std::span(cell_rows).subspan(cell_first[at], cell_first[at + 1] - cell_first[at]);
}

double Footprint::at(double px, double py) const {
    const double dx = px - x, dy = py - y;
    return std::exp(-0.5 * (a * dx * dx + 2 * b * dx * dy + c * dy * dy));
}

Footprint footprint(const Chart& chart, const SurfaceRow& row) {
    const Vec3 at = chart.local(row.at);
    double xx = LowPass * LowPass, xy = 0, yy = LowPass * LowPass;
    for (std::size_t k = 0; k < 3; ++k) {
        const double s = row.scale[k] / chart.cell;
        const double x = s * dot(row.axis[k], chart.u), y = s * dot(row.axis[k], chart.v);
        xx += x * x, xy += x * y, yy += y * y;
    }
    const double det = std::max(xx * yy - xy * xy, 1e-12);
    Footprint print{at.x, at.y, yy / det, -xy / det, xx / det};
    print.reach_x = std::min(3 * std::sqrt(xx), LongestReach);
    print.reach_y = std::min(3 * std::sqrt(yy), LongestReach);
    return print;
}

std::optional<Chart> make_chart(std::span<const SurfaceRow> rows, std::span<const std::uint8_t> taken,
                                const Plane& plane, double tolerance, const Body& body, const Vec3& up) {
    return Builder(rows, taken, plane, body).build(tolerance, up);
}

void draw_chart(Chart& chart, std::span<const SurfaceRow> rows) {
    const int width = chart.height.width, height = chart.height.height;
    const std::size_t cells = chart.height.cells.size();
    chart.through = Grid<double>(width, height, 1);
    chart.colour = Grid<Vec3>(width, height);
    std::vector<std::pair<double, std::uint32_t>> order;
    chart.cell_first.assign(cells + 1, 0);
    std::vector<std::size_t> place;
    for (const auto i : chart.own) {
        const Vec3 at = chart.local(rows[i].at);
        order.emplace_back(-at.z, i);
        place.push_back(chart.height.index(std::clamp(static_cast<int>(std::floor(at.x)), 0, width - 1),
                                           std::clamp(static_cast<int>(std::floor(at.y)), 0, height - 1)));
        ++chart.cell_first[place.back() + 1];
    }
    for (std::size_t c = 0; c < cells; ++c) chart.cell_first[c + 1] += chart.cell_first[c];
    chart.cell_rows.resize(chart.own.size());
    auto next = chart.cell_first;
    for (std::size_t k = 0; k < chart.own.size(); ++k) chart.cell_rows[next[place[k]]++] = chart.own[k];
    std::sort(order.begin(), order.end());
    chart.shown.assign(rows.size(), 0);
    for (const auto& [above, i] : order) {
        double shown = 0, all = 1e-9;
        each_covered(chart, rows[i], [&, colour = rows[i].colour](std::size_t cell, double opacity) {
            chart.colour.cells[cell] += colour * (chart.through.cells[cell] * opacity);
            shown += chart.through.cells[cell] * opacity, all += opacity;
            chart.through.cells[cell] *= 1 - opacity;
        });
        chart.shown[i] = static_cast<float>(shown / all);
    }
    std::vector<double> covers;
    for (std::size_t c = 0; c < cells; ++c) {
        const double cover = 1 - chart.through.cells[c];
        if (cover > 0) chart.colour.cells[c] /= cover;
        if (cover > LeastCover) covers.push_back(cover);
    }
    if (chart.known.cells.empty())  // the first drawing says what is usual here
        chart.usual_cover = covers.empty() ? 1 : upper_median(covers);
    chart.known = BitGrid(width, height, 0);
    for (std::size_t c = 0; c < cells; ++c)
        chart.known.cells[c] = 1 - chart.through.cells[c] >= UsualCoverShare * chart.usual_cover ? 1 : 0;
}

}  // namespace gse::heal
