// Cells that a thing stands on: nothing saw them, so that what a scan has there need not be true.
#pragma once

#include <functional>
#include <span>

#include "engine/heal/chart.h"

namespace gse::heal {

/// Cells under the lowest part of the body, without gaps. Empty where the body does not touch the surface.
BitGrid foot_cells(const Chart& chart, const Body& body);

/// True when the foot does not look like the surface around. Its rows are sparser or larger there, its light
/// or hue is none of a shadow, or many of its colours occur nowhere around.
bool foot_is_garbage(const Chart& chart, const BitGrid& foot, std::span<const SurfaceRow> rows);

/// Share of the cells just outside of `bits` that are known or a border. 1 = the surface shows all around.
double known_around(const Chart& chart, const BitGrid& bits, const BitGrid& border);

/// Calls call(index) for the rows over or in the foot that are no part of a surface: remains of the thing.
/// With `below`, also those beneath the surface. Rows with taken[index] != 0 belong to a surface.
void each_remain(const Chart& chart, const BitGrid& foot, std::span<const SurfaceRow> rows,
                 std::span<const std::uint8_t> taken, const Body& body, bool below,
                 const std::function<void(std::size_t)>& call);

/// Bits grown by a number of cells to all sides.
BitGrid grown(const BitGrid& bits, int cells);

}  // namespace gse::heal
