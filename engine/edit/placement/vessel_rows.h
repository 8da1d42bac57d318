// Vessel that a plant grows out of, told from the plant by shape (METHOD.md, Vessels and plants).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Rows [N] of a vessel, 0 or 1; both empty = none was found.
struct VesselRows {
    std::vector<std::uint8_t> vessel;
    std::vector<std::uint8_t> filling;  // inside it, below its rim: soil, and leaves that hang down
};

/// The vessel below or within the object that `bits` [N] label. A vessel is a surface of revolution about an
/// upright axis, as a vase or a flowerpot has it. A plant's rows right above it lie in no circle about that
/// axis.
///
/// Only for labels of vessels and of plants: a statue's round base is such a surface, too.
VesselRows vessel_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up,
                       const Vec3& front);

}  // namespace gse::edit
