// Axes, curves, names beside the points.
#include "engine/bench/pareto_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace gse::bench {
namespace {

using Point = std::array<double, 2>;

constexpr double Letter = 11, Small = 9.5, Line = 22;   // heights of capitals and of a line, pixels
constexpr int PlotHeight = 430, Left = 66, Right = 16, Bottom = 58;
constexpr DrawColour Ink{0.12f, 0.12f, 0.14f}, Dim{0.42f, 0.42f, 0.45f}, Grid{0.88f, 0.88f, 0.9f};

bool drawable(const ChartPoint& point) { return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0; }

struct Box {
    double left, top, right, bottom;
    bool meets(const Box& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
};

/// From values to pixels.
struct Scale {
    double x_low = 1, x_high = 10, y_low = 0, y_high = 1;   // values at the edges
    Box plot{};

    double x(double value) const {
        return plot.left + (plot.right - plot.left) * std::log(value / x_low) / std::log(x_high / x_low);
    }
    double y(double value) const { return plot.bottom - (plot.bottom - plot.top) * (value - y_low) / (y_high - y_low); }
};

Scale scale_of(const ChartPanel& panel, const Box& plot) {
    double low = std::numeric_limits<double>::infinity(), high = 0, least = 0, most = 0.1;
    for (const auto& curve : panel.curves)
        for (const auto& point : curve.points) {
            if (!drawable(point)) continue;
            low = std::min(low, point.x), high = std::max(high, point.x);
            least = std::min(least, point.y), most = std::max(most, point.y);
        }
    if (!(high > 0)) low = high = 1;
    constexpr double room = 1.6;   // beside the outermost points: their names stand there
    constexpr double step = 0.1;
    return {low / room, high * room, std::floor(least / step) * step, std::ceil((most + step / 2) / step) * step, plot};
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

std::vector<double> ticks_of(double low, double high) {
    std::vector<double> ticks;
    for (int power = -9; power <= 12; ++power)
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double tick = digit * std::pow(10.0, power);
            if (tick >= low && tick <= high) ticks.push_back(tick);
        }
    return ticks;
}

void draw_centred(Image& image, double x, double y, const std::string& text, double height, const DrawColour& colour) {
    draw_text(image, x - text_width(text, height) / 2, y, text, height, colour);
}

void draw_axes(Image& image, const ChartPanel& panel, const Scale& scale) {
    const Box& plot = scale.plot;
    constexpr double step = 0.1;
    for (double value = scale.y_low; value < scale.y_high + step / 2; value += step) {
        draw_line(image, {plot.left, scale.y(value)}, {plot.right, scale.y(value)}, 1, Grid);
        const std::string text = fmt::format("{:.0f} %", 100 * value);
        draw_text(image, plot.left - 8 - text_width(text, Small), scale.y(value) + Small / 2, text, Small, Dim);
    }
    double free_from = 0;   // names of ticks must not run into each other
    for (const double tick : ticks_of(scale.x_low, scale.x_high)) {
        draw_line(image, {scale.x(tick), plot.top}, {scale.x(tick), plot.bottom}, 1, Grid);
        const std::string text = fmt::format("{:g}", tick);
        const double width = text_width(text, Small);
        if (scale.x(tick) - width / 2 < free_from) continue;
        draw_centred(image, scale.x(tick), plot.bottom + 18, text, Small, Dim);
        free_from = scale.x(tick) + width / 2 + 10;
    }
    draw_line(image, {plot.left, plot.top}, {plot.left, plot.bottom}, 1.5, Ink);
    draw_line(image, {plot.left, plot.bottom}, {plot.right, plot.bottom}, 1.5, Ink);
    draw_centred(image, (plot.left + plot.right) / 2, plot.bottom + 44, panel.x_title, Letter, Ink);
    draw_text(image, plot.left - 50, plot.top - 14, panel.y_title, Letter, Ink);
}

/// Names keep off a line.
void cover_line(const std::vector<Point>& line, std::vector<Box>& taken) {
    constexpr int pieces = 40;
    for (std::size_t i = 1; i < line.size(); ++i)
        for (int k = 0; k <= pieces; ++k) {
            const double share = static_cast<double>(k) / pieces;
            const double x = line[i - 1][0] + share * (line[i][0] - line[i - 1][0]), y = line[i - 1][1] + share * (line[i][1] - line[i - 1][1]);
            taken.push_back({x - 2, y - 2, x + 2, y + 2});
        }
}

/// Where a name stands beside its point: the first place that is free.
Point free_place(const Point& at, double width, std::vector<Box>& taken) {
    constexpr double near = 13;
    const std::array<Point, 6> places{{{at[0] + near, at[1] + Small / 2},
                                       {at[0] - width / 2, at[1] - near},
                                       {at[0] - width / 2, at[1] + near + Small},
                                       {at[0] - near - width, at[1] + Small / 2},
                                       {at[0] + near, at[1] - near},
                                       {at[0] + near, at[1] + near + Small}}};
    const auto box = [&](const Point& place) { return Box{place[0] - 2, place[1] - Small - 2, place[0] + width + 2, place[1] + 3}; };
    const auto found = std::find_if(places.begin(), places.end(), [&](const Point& place) {
        return std::none_of(taken.begin(), taken.end(), [&](const Box& other) { return box(place).meets(other); });
    });
    const Point& place = found == places.end() ? places[0] : *found;
    taken.push_back(box(place));
    return place;
}

void draw_curves(Image& image, const ChartPanel& panel, const Scale& scale) {
    std::vector<Box> taken;
    const auto place = [&](const ChartPoint& point) { return Point{scale.x(point.x), scale.y(point.y)}; };
    for (const auto& curve : panel.curves) {
        std::vector<Point> line;
        for (const auto index : pareto_front(curve.points)) line.push_back(place(curve.points[index]));
        draw_polyline(image, line, 2, curve.colour);
        cover_line(line, taken);
        for (const auto& point : curve.points) {
            if (!drawable(point)) continue;
            const Point at = place(point);
            draw_dot(image, at, 5, curve.colour);
            if (point.marked) draw_ring(image, at, 10, 1, curve.colour);
            taken.push_back({at[0] - 10, at[1] - 10, at[0] + 10, at[1] + 10});
        }
    }
    for (const auto& curve : panel.curves)
        for (const auto& point : curve.points) {
            if (!drawable(point)) continue;
            const Point at = free_place(place(point), text_width(point.name, Small), taken);
            draw_text(image, at[0], at[1], point.name, Small, curve.colour);
        }
}

double draw_legend(Image& image, const Chart& chart, double y) {
    double x = Left;
    if (chart.panels.empty()) return y;
    for (const auto& curve : chart.panels.front().curves) {
        draw_line(image, {x, y - Letter / 2}, {x + 26, y - Letter / 2}, 2, curve.colour);
        draw_dot(image, {x + 13, y - Letter / 2}, 5, curve.colour);
        draw_text(image, x + 34, y, curve.name, Letter, Ink);
        x += 34 + text_width(curve.name, Letter) + 30;
    }
    return y + Line;
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (drawable(points[i])) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
        return points[a].x < points[b].x || (points[a].x == points[b].x && points[a].y > points[b].y);
    });
    std::vector<std::size_t> front;
    for (const auto index : order)
        if (front.empty() || points[index].y > points[front.back()].y) front.push_back(index);
    return front;
}

Image draw_chart(const Chart& chart) {
    constexpr int head = 92;
    const int foot = static_cast<int>(Line * static_cast<double>(chart.notes.size())) + 14;
    Image image(ChartWidth, head + PlotHeight + Bottom + foot, 3, 1.0f);
    draw_text(image, 16, 30, chart.title, Letter + 2, Ink);
    draw_legend(image, chart, 56);
    const double width = static_cast<double>(ChartWidth) / static_cast<double>(std::max<std::size_t>(1, chart.panels.size()));
    for (std::size_t i = 0; i < chart.panels.size(); ++i) {
        const double from = width * static_cast<double>(i);
        const Scale scale = scale_of(chart.panels[i], {from + Left, head, from + width - Right, head + PlotHeight});
        draw_axes(image, chart.panels[i], scale);
        draw_curves(image, chart.panels[i], scale);
    }
    double y = head + PlotHeight + Bottom + Line - 8;
    for (const auto& note : chart.notes) {
        draw_text(image, 16, y, note, Small, Dim);
        y += Line;
    }
    return image;
}

}  // namespace gse::bench
