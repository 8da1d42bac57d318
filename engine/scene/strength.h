// How much of an edit is seen: from none of it over what it came to up to colours beyond it.
#pragma once

#include <span>

#include "engine/scene/delta.h"

namespace gse {

constexpr double MostStrength = 2;

/// The delta at a strength in [0, MostStrength], over the rows it is applied to. 1 is the delta itself, bit
/// for bit; 0 changes nothing. Below 1 changed rows lie between before and after (positions, log-scales and
/// colours on the straight line, rotations by normalised quaternions, opacities by what they cover), added
/// rows are that much fainter, and removed ones come back as faintly as is left to 1. Above 1 colours go on
/// along their line, as far as a file can hold them; all else stays. Rows that the delta does not name stay
/// out of it.
SceneDelta with_strength(const GaussianSet& before, std::span<const RowId> ids, const SceneDelta& delta,
                         double strength);

}  // namespace gse
