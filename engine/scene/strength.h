// Strength of an edit: from none over the whole edit up to colours beyond it.
#pragma once

#include <span>

#include "engine/scene/delta.h"

namespace gse {

constexpr double MostStrength = 2;

/// The delta at a strength in [0, MostStrength], over the rows it is applied to. 1 is the delta itself, bit
/// for bit; 0 changes nothing.
///
/// Below 1, changed rows lie between before and after. Positions, log-scales and colours lie on the straight
/// line. Rotations are normalised quaternions, and opacities follow the covered area. Added rows are fainter
/// by the strength; removed ones come back faintly by the rest. Rows that turn as one, and change nothing
/// else, go along their turn (share_of_turn()).
///
/// Above 1, colours go on along their line, as far as a file can hold them. All other values stay. Rows that
/// the delta does not name stay out of it.
SceneDelta with_strength(const GaussianSet& before, std::span<const RowId> ids, const SceneDelta& delta,
                         double strength);

}  // namespace gse
