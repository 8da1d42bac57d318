// Cells of a surface that a thing hid: uncovered, near the thing, and between covered ones.
#pragma once

#include <span>

#include "engine/heal/chart.h"
#include "engine/heal/distance.h"

namespace gse::heal {

/// Cells where another surface that is there cuts this one: a floor ends at the wall. `near` marks the cells
/// of every chart that may be hidden by the thing, in the order of `charts`. 2 = already beyond the cut.
BitGrid borders(std::span<const Chart> charts, std::span<const BitGrid> near, std::size_t which);

struct Hole {
    BitGrid cells;         // to be filled
    std::size_t open = 0;  // cells that may have been surface but that nothing bounds on enough sides
};

/// Uncovered cells of `near` with covered ones or a border on opposite sides: in two of eight orientations
/// where `core` says that the thing was there, in four elsewhere. So a table's edge goes on straight, and
/// nothing is added beyond it. Specks are left out.
Hole find_hole(const Chart& chart, const BitGrid& near, const BitGrid& core, const BitGrid& border);

/// Drops holes before which or close behind which lies something else: the floor under the table that the
/// thing stands on, or a gap above a lower surface. Rows with removed[row] != 0 do not count.
void drop_shown(const Chart& chart, std::span<const SurfaceRow> rows, std::span<const std::uint8_t> removed,
                const Body& body, BitGrid& cells);

/// Drops lines of cells, as along an edge that rows cover in part, but for those at the thing's foot.
void drop_seams(BitGrid& cells, const BitGrid& foot);

/// Groups of cells that touch each other, by sides and corners: numbers from 1; 0 = no bit.
Grid<int> groups_of(const BitGrid& bits, std::vector<std::size_t>& sizes);

}  // namespace gse::heal
