// A chart of what methods reach against what they cost: one curve per method, cost on a logarithmic axis.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/io/drawing.h"

namespace gse::bench {

struct ChartPoint {
    double x = 0, y = 0;       // x above 0
    std::string name;
    bool marked = false;       // gets a ring
};

/// The line of a curve goes through its points that no cheaper one reaches.
struct ChartCurve {
    std::string name;
    DrawColour colour{};
    std::vector<ChartPoint> points;
};

struct ChartPanel {
    std::string x_title, y_title;
    std::vector<ChartCurve> curves;
};

struct Chart {
    std::string title;
    std::vector<std::string> notes;      // below, one line each
    std::vector<ChartPanel> panels;      // beside each other, with the same curves
};

constexpr int ChartWidth = 1200;   // pixels

/// [H,ChartWidth,3]; points whose coordinates are not finite, or whose x is not above 0, are left out.
Image draw_chart(const Chart& chart);

/// Indices of the points that no cheaper point reaches, by ascending x.
std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points);

}  // namespace gse::bench
