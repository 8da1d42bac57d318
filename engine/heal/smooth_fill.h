// Smooth values for the cells of a hole: a membrane from its rim, and heights that go on with their
// curvature.
#pragma once

#include "engine/heal/chart.h"

namespace gse::heal {

/// Solves the Laplace equation over the cells of `fill`; cells of `fixed` keep their values. Others are left
/// out, as if the surface ended there. Cells that nothing fixed is joined to keep what they have.
void fill_membrane(Grid<double>& values, const BitGrid& fill, const BitGrid& fixed);
void fill_membrane(Grid<Vec3>& values, const BitGrid& fill, const BitGrid& fixed);

/// Heights of the hole's cells: a quadric through the cells around each hole, by robust least squares, and a
/// membrane for what it leaves at the rim. Other cells without rows take the heights around them.
void fill_heights(Chart& chart, const BitGrid& hole);

}  // namespace gse::heal
