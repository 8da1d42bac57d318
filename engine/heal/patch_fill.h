// Texture for the cells of a hole, taken from patches around it: PatchMatch (Barnes et al. 2009) with the
// multi-scale completion of Wexler et al. (2007).
#pragma once

#include <cstdint>

#include "engine/heal/grid.h"
#include "engine/math/vec.h"

namespace gse::heal {

/// Move of a cell to the one that it is copied from.
struct Shift {
    std::int16_t x = 0, y = 0;
    bool operator==(const Shift&) const = default;
};

struct PatchFill {
    bool found = false;  // false = nothing around is large enough to copy from
    Grid<Shift> shift;   // of the hole's cells
    Grid<Vec3> colour;   // the hole's cells have those that they are copied from
};

/// Shifts for the cells of `hole`. Sources are cells of `known`, but for those of `avoid` if others suffice.
/// Cells that are neither are void, as beyond the edge of a table; an edge is continued like edges elsewhere.
/// Equal seeds give equal results.
PatchFill fill_by_patches(const Grid<Vec3>& colour, const BitGrid& known, const BitGrid& hole,
                          const BitGrid& avoid, std::uint64_t seed);

}  // namespace gse::heal
