// Axes, curves, names beside the points.
#include "engine/laboratory/bench/charts/pareto_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace gse::bench {
namespace {

using Point = std::array<double, 2>;

constexpr double Letter = 11, Small = 9.5, Line = 22;  // heights of capitals and of a line, pixels
constexpr int Columns = 2;
constexpr double Left = 78, Right = 20, Above = 14, Below = 62, Margin = 16;  // around a plot, and around all
constexpr DrawColour Ink{0.12f, 0.12f, 0.14f}, Dim{0.42f, 0.42f, 0.45f}, Grid{0.88f, 0.88f, 0.9f},
    Front{0.62f, 0.62f, 0.66f};

bool drawable(const ChartPoint& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0;
}

bool drawable_on(const ChartPanel& panel, const ChartPoint& point) {
    return drawable(point) && (panel.y_scale != ChartScale::Logarithmic || point.y > 0);
}

struct Box {
    double left, top, right, bottom;
    bool meets(const Box& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
    bool holds(const Box& other) const {
        return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
    }
};

/// From values to pixels.
struct Scale {
    double x_low = 1, x_high = 10, y_low = 0, y_high = 1;  // values at the edges
    bool y_logarithmic = false;
    Box plot{};

    double x(double value) const {
        return plot.left + (plot.right - plot.left) * std::log(value / x_low) / std::log(x_high / x_low);
    }
    double y(double value) const {
        const double share = y_logarithmic ? std::log(value / y_low) / std::log(y_high / y_low)
                                           : (value - y_low) / (y_high - y_low);
        return plot.bottom - (plot.bottom - plot.top) * share;
    }
};

/// Least and greatest of what is drawn.
struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    void take(double value) { low = std::min(low, value), high = std::max(high, value); }
    bool empty() const { return !(high >= low); }
};

void set_y(Scale& scale, const ChartPanel& panel, Extent y) {
    constexpr double step = 0.1, room = 0.08;  // of shares; of the height, above and below what is drawn
    if (panel.y_scale == ChartScale::Percent) {
        y.take(0), y.take(step);
        scale.y_low = std::floor(y.low / step) * step,
        scale.y_high = std::ceil((y.high + step / 2) / step) * step;
        return;
    }
    scale.y_logarithmic = panel.y_scale == ChartScale::Logarithmic;
    if (y.empty()) y.take(scale.y_logarithmic ? 1.0 : 0.0);
    if (scale.y_logarithmic) {
        constexpr double least = 2;  // a lone point lies between its half and its double
        const double factor = std::max(std::pow(y.high / y.low, 1.5 * room), least);
        scale.y_low = y.low / factor, scale.y_high = y.high * factor;
    } else {
        const double wide = y.high > y.low ? y.high - y.low : std::max(std::abs(y.high), 1.0);
        scale.y_low = y.low - room * wide, scale.y_high = y.high + room * wide;
    }
}

Scale scale_of(const ChartPanel& panel, const Box& plot) {
    Extent x, y;
    for (const auto& curve : panel.curves)
        for (const auto& point : curve.points)
            if (drawable_on(panel, point)) x.take(point.x), y.take(point.y);
    if (x.empty()) x.take(1);
    for (const auto& guide : panel.guides)
        if (guide.x > 0) x.take(guide.x);
    const double room = std::max(
        1.25, std::pow(x.high / x.low, 0.1));  // beside the outermost points: their names stand there
    Scale scale;
    scale.x_low = x.low / room, scale.x_high = x.high * room, scale.plot = plot;
    set_y(scale, panel, y);
    return scale;
}

void draw_line(Image& image, Point from, Point to, double thickness, const DrawColour& colour) {
    const std::array<Point, 2> ends{from, to};
    draw_polyline(image, ends, thickness, colour);
}

void draw_ring(Image& image, Point centre, double radius, double thickness, const DrawColour& colour) {
    constexpr int corners = 40;
    std::vector<Point> circle;
    for (int i = 0; i <= corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        circle.push_back({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
    }
    draw_polyline(image, circle, thickness, colour);
}

void draw_dot(Image& image, Point centre, double radius, const DrawColour& colour) {
    for (double r = radius; r > 0; r -= 1) draw_ring(image, centre, r, 1.5, colour);
}

void draw_centred(Image& image, double x, double y, const std::string& text, double height,
                  const DrawColour& colour) {
    draw_text(image, x - text_width(text, height) / 2, y, text, height, colour);
}

std::vector<double> y_ticks(const ChartPanel& panel, const Scale& scale) {
    constexpr double spacing = 42;  // pixels between ticks, about
    const int count = std::max(2, static_cast<int>((scale.plot.bottom - scale.plot.top) / spacing));
    return panel.y_scale == ChartScale::Logarithmic ? logarithmic_ticks(scale.y_low, scale.y_high)
                                                    : linear_ticks(scale.y_low, scale.y_high, count);
}

void draw_axes(Image& image, const ChartPanel& panel, const Scale& scale) {
    const Box& plot = scale.plot;
    double free_below = 1e9;  // names of ticks must not run into each other
    for (const double value : y_ticks(panel, scale)) {
        draw_line(image, {plot.left, scale.y(value)}, {plot.right, scale.y(value)}, 1, Grid);
        const std::string text =
            panel.y_scale == ChartScale::Percent ? fmt::format("{:.3g} %", 100 * value) : number_text(value);
        if (scale.y(value) + Small > free_below) continue;
        draw_text(image, plot.left - 8 - text_width(text, Small), scale.y(value) + Small / 2, text, Small,
                  Dim);
        free_below = scale.y(value) - Small;
    }
    double free_from = 0;
    for (const double tick : logarithmic_ticks(scale.x_low, scale.x_high)) {
        draw_line(image, {scale.x(tick), plot.top}, {scale.x(tick), plot.bottom}, 1, Grid);
        const std::string text = number_text(tick);
        const double width = text_width(text, Small);
        if (scale.x(tick) - width / 2 < free_from) continue;
        draw_centred(image, scale.x(tick), plot.bottom + 18, text, Small, Dim);
        free_from = scale.x(tick) + width / 2 + 10;
    }
    draw_line(image, {plot.left, plot.top}, {plot.left, plot.bottom}, 1.5, Ink);
    draw_line(image, {plot.left, plot.bottom}, {plot.right, plot.bottom}, 1.5, Ink);
    draw_centred(image, (plot.left + plot.right) / 2, plot.bottom + 42, panel.x_title, Letter, Ink);
}

/// Names keep off a line.
void cover_line(const std::vector<Point>& line, std::vector<Box>& taken) {
    constexpr int pieces = 40;
    for (std::size_t i = 1; i < line.size(); ++i)
        for (int k = 0; k <= pieces; ++k) {
            const double share = static_cast<double>(k) / pieces;
            const double x = line[i - 1][0] + share * (line[i][0] - line[i - 1][0]);
            const double y = line[i - 1][1] + share * (line[i][1] - line[i - 1][1]);
            taken.push_back({x - 2, y - 2, x + 2, y + 2});
        }
}

/// A name's left end and baseline, and whether it stands so far off that a line must lead to it.
struct Place {
    Point at;
    bool far = false;
};

/// Place of a name beside its point: the first one within the plot that is free; nothing when none is.
std::optional<Place> free_place(const Point& at, double width, const Box& plot, std::vector<Box>& taken) {
    const auto try_place = [&](const Point& place, bool far) -> std::optional<Place> {
        const Box box{place[0] - 2, place[1] - Small - 2, place[0] + width + 2, place[1] + 3};
        if (!plot.holds(box) ||
            std::any_of(taken.begin(), taken.end(), [&](const Box& other) { return box.meets(other); }))
            return {};
        taken.push_back(box);
        return Place{place, far};
    };
    constexpr double near = 15, ring = 15, outermost = 64;
    for (double away = near; away <= outermost; away += ring) {
        const double middle = at[0] - width / 2, beside = at[0] + away, before = at[0] - away - width;
        const std::array<Point, 8> places{{{beside, at[1] + Small / 2},
                                           {middle, at[1] - away},
                                           {middle, at[1] + away + Small},
                                           {before, at[1] + Small / 2},
                                           {beside, at[1] - away},
                                           {beside, at[1] + away + Small},
                                           {before, at[1] - away},
                                           {before, at[1] + away + Small}}};
        for (const auto& place : places)
            if (const auto found = try_place(place, away > near)) return found;
    }
    return {};
}

void draw_name(Image& image, const ChartPoint& point, const Point& at, const Box& plot,
               const DrawColour& colour, std::vector<Box>& taken) {
    if (point.name.empty()) return;
    const double width = text_width(point.name, Small);
    const auto place = free_place(at, width, plot, taken);
    if (!place) return;
    if (place->far) {
        const Point end{std::clamp(at[0], place->at[0], place->at[0] + width),
                        place->at[1] > at[1] ? place->at[1] - Small - 2 : place->at[1] + 3};
        draw_line(image, at, end, 1, Front);
        cover_line({at, end}, taken);
    }
    draw_text(image, place->at[0], place->at[1], point.name, Small, colour);
}

std::vector<Point> line_of(const ChartPanel& panel, const std::vector<ChartPoint>& points,
                           const Scale& scale) {
    std::vector<ChartPoint> shown;
    for (const auto& point : points)
        if (drawable_on(panel, point)) shown.push_back(point);
    std::vector<Point> line;
    if (panel.line == ChartLine::AllPoints) {
        for (const auto& point : shown) line.push_back({scale.x(point.x), scale.y(point.y)});
        return line;
    }
    for (const auto index : pareto_front(shown, panel.less_is_better))
        line.push_back({scale.x(shown[index].x), scale.y(shown[index].y)});
    return line;
}

void draw_lines(Image& image, const ChartPanel& panel, const Scale& scale, std::vector<Box>& taken) {
    for (const auto& guide : panel.guides) {
        if (!(guide.x > 0)) continue;
        const double x = scale.x(guide.x), top = scale.plot.top;
        for (double y = top; y < scale.plot.bottom; y += 12)
            draw_line(image, {x, y}, {x, std::min(y + 6, scale.plot.bottom)}, 1, Dim);
        cover_line({{x, top}, {x, scale.plot.bottom}}, taken);
        const double width = text_width(guide.name, Small);
        const double left = x + 8 + width < scale.plot.right ? x + 8 : x - 8 - width;
        draw_text(image, left, top + Small + 4, guide.name, Small, Dim);
        taken.push_back({left - 2, top, left + width + 2, top + Small + 8});
    }
    const auto draw = [&](const std::vector<Point>& line, const DrawColour& colour) {
        draw_polyline(image, line, 2, colour);
        cover_line(line, taken);
    };
    if (panel.line == ChartLine::CommonFront) {
        std::vector<ChartPoint> all;
        for (const auto& curve : panel.curves)
            all.insert(all.end(), curve.points.begin(), curve.points.end());
        draw(line_of(panel, all, scale), Front);
        return;
    }
    for (const auto& curve : panel.curves) draw(line_of(panel, curve.points, scale), curve.colour);
}

void draw_curves(Image& image, const ChartPanel& panel, const Scale& scale) {
    std::vector<Box> taken;
    const auto place = [&](const ChartPoint& point) { return Point{scale.x(point.x), scale.y(point.y)}; };
    draw_lines(image, panel, scale, taken);
    for (const auto& curve : panel.curves)
        for (const auto& point : curve.points) {
            if (!drawable_on(panel, point)) continue;
            const Point at = place(point);
            const double room = point.marked ? 11 : 7;
            draw_dot(image, at, 5, curve.colour);
            if (point.marked) draw_ring(image, at, 10, 1.5, Ink);
            taken.push_back({at[0] - room, at[1] - room, at[0] + room, at[1] + room});
        }
    for (const bool marked : {true, false})  // what is marked is named first
        for (const auto& curve : panel.curves)
            for (const auto& point : curve.points)
                if (point.marked == marked && drawable_on(panel, point))
                    draw_name(image, point, place(point), scale.plot, curve.colour, taken);
}

/// Entries of a legend.
struct Legend {
    std::vector<ChartCurve> curves;  // without points
    bool front = false, mark = false;
    friend bool operator==(const Legend& a, const Legend& b) {
        return a.front == b.front && a.mark == b.mark && a.curves.size() == b.curves.size() &&
               std::equal(
                   a.curves.begin(), a.curves.end(), b.curves.begin(),
                   [](const auto& x, const auto& y) { return x.name == y.name && x.colour == y.colour; });
    }
};

Legend legend_of(const ChartPanel& panel) {
    Legend legend;
    legend.front = panel.line == ChartLine::CommonFront;
    for (const auto& curve : panel.curves) {
        if (!curve.name.empty()) legend.curves.push_back({curve.name, curve.colour, {}});
        for (const auto& point : curve.points) legend.mark = legend.mark || point.marked;
    }
    return legend;
}

/// From (x, y) on, breaking lines at `right`; returns the y of the last line. Draws nothing without an image.
double draw_legend(Image* image, const Legend& legend, const std::string& mark, double left, double right,
                   double y) {
    constexpr double sample = 26, gap = 8, between = 24;
    double x = left;
    const auto entry = [&](const std::string& name, const auto& draw) {
        const double width = sample + gap + text_width(name, Letter);
        if (x > left && x + width > right) x = left, y += Line;
        if (image != nullptr) {
            draw(Point{x + sample / 2, y - Letter / 2});
            draw_text(*image, x + sample + gap, y, name, Letter, Ink);
        }
        x += width + between;
    };
    const auto stroke = [&](const Point& middle, const DrawColour& colour) {
        draw_line(*image, {middle[0] - sample / 2, middle[1]}, {middle[0] + sample / 2, middle[1]}, 2,
                  colour);
    };
    for (const auto& curve : legend.curves)
        entry(curve.name, [&](const Point& middle) {
            if (!legend.front) stroke(middle, curve.colour);
            draw_dot(*image, middle, 5, curve.colour);
        });
    if (legend.front)
        entry("front: nothing cheaper is better", [&](const Point& middle) { stroke(middle, Front); });
    if (legend.mark) entry(mark, [&](const Point& middle) { draw_ring(*image, middle, 10, 1.5, Ink); });
    return y;
}

/// Lines not longer than the picture is wide.
std::vector<std::string> broken_lines(const std::vector<std::string>& notes) {
    std::vector<std::string> lines;
    for (const auto& note : notes) {
        std::string line;
        for (std::size_t at = 0; at < note.size();) {
            const auto end = std::min(note.find(' ', at + 1), note.size());
            const std::string longer = line + note.substr(at, end - at);
            if (!line.empty() && text_width(longer, Small) > ChartWidth - 2 * Margin) {
                lines.push_back(line);
                line = note.substr(at + 1, end - at - 1);
            } else {
                line = longer;
            }
            at = end;
        }
        lines.push_back(line);
    }
    return lines;
}

bool one_legend(const Chart& chart) {
    for (const auto& panel : chart.panels)
        if (!(legend_of(panel) == legend_of(chart.panels.front()))) return false;
    return true;
}

/// Height of what stands above a plot of this row: titles and, where panels differ, legends.
double head_of_row(const Chart& chart, std::size_t first, double width, bool shared) {
    double height = Above + Line;
    for (std::size_t i = first; i < std::min(first + Columns, chart.panels.size()); ++i) {
        const auto& panel = chart.panels[i];
        double own = Above + Line + (panel.title.empty() ? 0 : Line);
        if (!shared)
            own += Line + draw_legend(nullptr, legend_of(panel), chart.mark, Margin, width - Right, 0);
        height = std::max(height, own);
    }
    return height;
}

void draw_panel(Image& image, const Chart& chart, const ChartPanel& panel, const Box& cell, bool shared) {
    const Box plot{cell.left + Left, cell.bottom - Below - chart.plot_height, cell.right - Right,
                   cell.bottom - Below};
    double y = cell.top + Letter + 4;
    if (!panel.title.empty())
        draw_text(image, cell.left + Margin, y, panel.title, Letter + 1, Ink), y += Line;
    if (!shared)
        draw_legend(&image, legend_of(panel), chart.mark, cell.left + Margin, cell.right - Right, y + 2);
    draw_text(image, cell.left + Margin, plot.top - 12, panel.y_title, Letter, Ink);
    const Scale scale = scale_of(panel, plot);
    draw_axes(image, panel, scale);
    draw_curves(image, panel, scale);
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points, bool less_is_better) {
    const auto better = [&](double a, double b) { return less_is_better ? a < b : a > b; };
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (drawable(points[i])) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
        return points[a].x < points[b].x || (points[a].x == points[b].x && better(points[a].y, points[b].y));
    });
    std::vector<std::size_t> front;
    for (const auto index : order)
        if (front.empty() || better(points[index].y, points[front.back()].y)) front.push_back(index);
    return front;
}

Image draw_chart(const Chart& chart) {
    const auto notes = broken_lines(chart.notes);
    const auto count = chart.panels.size();
    const double width =
        static_cast<double>(ChartWidth) / static_cast<double>(std::clamp<std::size_t>(count, 1, Columns));
    const bool shared = one_legend(chart);
    double top = 48;
    const double legend_y = top + 8;
    if (shared && count > 0)
        top = Line * 0.8 + draw_legend(nullptr, legend_of(chart.panels.front()), chart.mark, Margin,
                                       ChartWidth - Margin, legend_y);
    std::vector<double> rows{top};  // tops of the rows of panels, and the end of the last
    for (std::size_t first = 0; first < count; first += Columns)
        rows.push_back(rows.back() + head_of_row(chart, first, width, shared) + chart.plot_height + Below);
    const double height = rows.back() + Line * static_cast<double>(notes.size()) + Margin;
    Image image(ChartWidth, static_cast<int>(height), 3, 1.0f);
    draw_text(image, Margin, 30, chart.title, Letter + 2, Ink);
    if (shared && count > 0)
        draw_legend(&image, legend_of(chart.panels.front()), chart.mark, Margin, ChartWidth - Margin,
                    legend_y);
    for (std::size_t i = 0; i < count; ++i) {
        const double left = width * static_cast<double>(i % Columns);
        draw_panel(image, chart, chart.panels[i],
                   {left, rows[i / Columns], left + width, rows[i / Columns + 1]}, shared);
    }
    double y = rows.back() + Letter;
    for (const auto& note : notes) draw_text(image, Margin, y, note, Small, Dim), y += Line;
    return image;
}

}  // namespace gse::bench
