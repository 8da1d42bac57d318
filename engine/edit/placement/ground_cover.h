// Test whether an object stands on anything, or was cut out of its surroundings.
#pragma once

#include <cstdint>
#include <span>

#include "engine/edit/placement/upright_bounds.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// Cover of the ground around an object by rows that `bits` [N] do not label, in [0,1]. It is the mean
/// opacity, seen from straight above, of rows at the height of its foot and below (a hat is worn above the
/// ground). The ring reaches from the object as far out as a figure of its size is high. 0 if nothing stands.
double ground_cover(const GaussianSet& set, std::span<const std::uint8_t> bits, const UprightBounds& standing,
                    const Vec3& up, raster::Rasterizer& rasterizer);

/// Cover for a whole scene. Some rows suffice for a large one.
UprightBounds standing_of_scene(const GaussianSet& set, const Vec3& up);

/// Cover of the ground around everything that rises out of the lower quarter of a scene. `whole` is its
/// place.
double ground_of_scene(const GaussianSet& set, const UprightBounds& whole, const Vec3& up,
                       raster::Rasterizer& rasterizer);

}  // namespace gse::edit
