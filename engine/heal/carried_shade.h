// The shadow of a thing, on the ground of another place.
#pragma once

#include <span>
#include <vector>

#include "engine/heal/heal.h"
#include "engine/scene/transform/affine.h"

namespace gse::heal {

/// Factors of the rows' colours [N] in the shadow that a thing takes along under a map; 1 = no shadow. Rows
/// count that lie as far from the moved thing as the shadowed ground did, to a cell of that. A shadow that
/// was not measured gives 1.
std::vector<Vec3> carried_shade(const Shadow& shadow, const Affine& placement, const GaussianSet& set);

/// Appends a copy of the row with its colours times `light`. 1 keeps their bits.
void append_lit(const GaussianSet& set, std::size_t row, const Vec3& light, GaussianData& added);

/// The set with the colours of each row times its `light` [N]. 1 keeps their bits.
GaussianSet lit(const GaussianSet& set, std::span<const Vec3> light);

}  // namespace gse::heal
