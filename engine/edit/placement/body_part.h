// Parts of a labelled thing that its shape tells, for models that have no word for them.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Tells whether labelled_part() knows a part of that name: "head", "upper half".
bool is_told_by_shape(std::string_view part);

/// Rows [N] of the part among the rows that `bits` [N] label; all 0 where the shape does not tell the part.
///
/// A half ends at half of the height. The head is the topmost piece down to a neck that is narrower than what
/// is above and below it. A thing without such a neck has no head: many animals on four legs.
std::vector<std::uint8_t> labelled_part(std::string_view part, const GaussianSet& set,
                                        std::span<const std::uint8_t> bits, const Vec3& up);

}  // namespace gse::edit
