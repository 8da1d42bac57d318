// Parts beside a labelled thing that its name says are none of it: a pedestal, a plant, a vessel.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/scene/gaussian_set.h"
#include "engine/scene/label_field.h"

namespace gse::edit {

/// Nature of the things that a noun names.
ThingNature nature_of(std::string_view noun);

/// Rows that a thing's shape tells from it, and rows of its own that its label lacks.
struct PartsBeside {
    const char* name = "";             // of the other thing, for the log
    std::vector<std::uint8_t> rows;    // [N] 0 or 1, or empty: none were found
    std::vector<std::size_t> lacking;  // ascending
};

/// Parts beside the thing that `bits` [N] label: a pedestal under a figure, the plant in a vessel, the vessel
/// under a plant (pedestal_rows.h, vessel_rows.h).
PartsBeside parts_beside(const GaussianSet& set, const std::vector<std::uint8_t>& bits, ThingNature nature,
                         const Vec3& up, const Vec3& front);

/// Label [N] of a thing that was pointed at, less the plant in a vessel or the vessel under a plant. Who
/// points at a figure says with what.
std::vector<std::uint8_t> without_parts_beside(const GaussianSet& set, std::vector<std::uint8_t> bits,
                                               ThingNature nature, const Vec3& up);

}  // namespace gse::edit
