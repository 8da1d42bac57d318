// The shadow that a thing leaves on a surface, and odd colours beneath it that no picture showed.
#pragma once

#include "engine/heal/chart.h"

namespace gse::heal {

struct Shade {
    std::vector<Vec3> gain;  // [own rows of the chart] factor per channel that lights a row again; 1 = none
    BitGrid garbage;         // known cells under the thing whose colours occur nowhere around
};

/// Lights the rows in the shadow around the hole and the thing's foot again, and draws the chart with them.
/// The shadow is joined to the foot. It is clearly darker than the surface beyond `reach` cells, by more than
/// that varies itself, and of its hue. `to_body`: distance_to_body().
Shade find_shade(Chart& chart, std::span<SurfaceRow> rows, const BitGrid& hole, const Grid<double>& to_body,
                 double reach);

}  // namespace gse::heal
