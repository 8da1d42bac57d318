// The shadow that a thing leaves on a surface.
#pragma once

#include "engine/heal/chart.h"

namespace gse::heal {

struct Shade {
    std::vector<Vec3> gain;  // [rows] factor per channel that lights a row again; 1 = none
    BitGrid deep;            // cells in a shadow that is too deep to be lit
};

/// Lights the rows in the shadow around the hole and the thing's foot again, and draws the chart with them.
/// The shadow is joined to the foot. It is clearly darker than the surface beyond `reach` cells, by more than
/// that varies itself, and of its hue.
Shade find_shade(Chart& chart, std::span<SurfaceRow> rows, const BitGrid& hole, const BitGrid& foot,
                 double reach);

}  // namespace gse::heal
