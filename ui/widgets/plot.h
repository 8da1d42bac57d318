// Curves over iterations: linear or logarithmic, with a legend to switch them and the values under the
// cursor.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

/// One curve. `value(i)` is the height of point i. `shown` is switched by a click on the legend.
struct Curve {
    const char* label;
    ImU32 colour;
    std::function<float(std::size_t)> value;
    bool* shown;
};

struct PlotOptions {
    std::string_view name;
    float height = 0;  // pixels, legend included
    bool logarithmic = false;
    int last_iteration = 0;  // right end of the axis; 0 = the last point
    int marker = -1;         // iteration marked by a line, negative = none
};

void plot(Context& context, const PlotOptions& options, std::span<const LossPoint> points,
          std::span<const Curve> curves);

}  // namespace gse::ui
