// Charts of the benches: what settings reach against what they cost, and how cost grows with size.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/io/image/drawing.h"

namespace gse::bench {

struct ChartPoint {
    double x = 0, y = 0;  // x above 0; y too where its axis is logarithmic
    std::string name;
    bool marked = false;  // gets a ring
};

struct ChartCurve {
    std::string name;
    DrawColour colour{};
    std::vector<ChartPoint> points;
};

/// Points that a panel's lines go through: those of each curve that no cheaper one reaches, those of all
/// curves together, or all points.
enum class ChartLine { OwnFront, CommonFront, AllPoints };

enum class ChartScale { Percent, Linear, Logarithmic };

/// A place on the cost axis that means something.
struct ChartGuide {
    double x = 0;
    std::string name;
};

struct ChartPanel {
    std::string x_title, y_title;  // with units
    std::vector<ChartCurve> curves;
    ChartLine line = ChartLine::OwnFront;
    // Percent: shares, from 0 on; the cost axis is always logarithmic.
    ChartScale y_scale = ChartScale::Percent;
    bool less_is_better = false;  // of y
    std::string title = {};       // above it, where there are several
    std::vector<ChartGuide> guides = {};
};

struct Chart {
    std::string title;
    std::vector<std::string> notes;  // below; what is too long for a line is broken
    std::vector<ChartPanel> panels;  // two beside each other
    int plot_height = 430;           // of a panel, pixels
    std::string mark = "default";    // what a ring means
};

constexpr int ChartWidth = 1200;  // pixels

/// [H,ChartWidth,3]; points that the axes cannot show (not finite, or not above 0 on a logarithmic axis) are
/// left out. Names of points never lie on each other: one that finds no place is left out.
Image draw_chart(const Chart& chart);

/// Indices of the points that no cheaper point reaches, by ascending x.
std::vector<std::size_t> pareto_front(const std::vector<ChartPoint>& points, bool less_is_better = false);

/// Round numbers from `low` to `high` (not more than about `count`), for a linear axis.
std::vector<double> linear_ticks(double low, double high, int count);
/// Ticks of a logarithmic axis: powers of ten, with their double and fivefold where there are few.
std::vector<double> logarithmic_ticks(double low, double high);
/// A number on an axis or in a table: three digits, thousands grouped, powers of ten where it is very small
/// or large.
std::string number_text(double value);

}  // namespace gse::bench
