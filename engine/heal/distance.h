// Exact distance transforms of grids (Felzenszwalb and Huttenlocher, Distance Transforms of Sampled
// Functions, 2012).
#pragma once

#include "engine/heal/grid.h"

namespace gse::heal {

/// Value that stands for "nothing here" in a grid of squared distances.
inline constexpr double FarAway = 1e20;

/// Replaces every value by the least of value(q) + |p - q|^2 over all cells q. Distances are in cells.
void spread_squared_distances(Grid<double>& values);

/// Distance in cells from every cell to the nearest one with a bit; FarAway without any.
Grid<double> distance_to(const BitGrid& bits);

}  // namespace gse::heal
