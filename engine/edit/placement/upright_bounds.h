// Place and size of a standing object. The room for its replacement and the cameras that frame it follow from
// them.
#pragma once

#include <cstdint>
#include <span>

#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Labelled object on its ground, world units. All zero if no labelled row can be seen.
struct UprightBounds {
    Vec3 foot;                   // the middle of where it stands, at the height of the ground
    double height = 0;           // above the foot
    double side = 0, depth = 0;  // its horizontal extents, across the front and along it
    bool found() const { return height > 0 && (side > 0 || depth > 0); }
    double width() const { return side > depth ? side : depth; }
};

/// Bounds of the rows that `bits` [N] label. The foot is the middle of the lowest part, since a tail or a
/// head may reach out. Its height is that of unlabelled rows that reach out from under it, if there are such
/// near its lowest ones or below. A label may lack a stem, or hold some ground. The outermost rows and those
/// too faint to be seen do not count.
UprightBounds standing_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                          const Vec3& front);
/// Bounds of a part cut out of an object. Nothing around it is the ground that it stands on.
UprightBounds standing_alone(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                             const Vec3& front);

/// Height of a figure that would stand there, in world units. An object wider than high counts as high as
/// others of its width, like a car beside a bear.
double figure_height(const UprightBounds& standing);

}  // namespace gse::edit
