// Where a thing stands and how large it is: from this follow the room for what takes its place, and the
// cameras that frame it.
#pragma once

#include <cstdint>
#include <span>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// A labelled thing on its ground, world units. All zero where no labelled row can be seen.
struct UprightBounds {
    Vec3 foot;                   // the middle of where it stands, at the height of the ground
    double height = 0;           // above the foot
    double side = 0, depth = 0;  // its horizontal extents, across the front and along it
    bool found() const { return height > 0 && (side > 0 || depth > 0); }
    double width() const { return side > depth ? side : depth; }
};

/// Of what `bits` [N] label. Its foot is the middle of its lowest part (a tail or a head reaches out of a
/// thing's middle, but stands on nothing), at the height of the rows around, not labelled, that reach out
/// from under it, where there are such near its lowest ones or below them (a label may lack a stem, or hold
/// some ground). The outermost rows and those too faint to be seen do not count.
UprightBounds standing_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                          const Vec3& front);
/// The same of a part cut out of a thing: nothing around it is the ground that it stands on.
UprightBounds standing_alone(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                             const Vec3& front);

/// How high a figure would be that stands there: what is wider than high counts as high as others of its
/// width are, as a car does beside a bear. World units.
double figure_height(const UprightBounds& standing);

}  // namespace gse::edit
