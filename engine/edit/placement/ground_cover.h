// Whether a thing stands on anything, or was cut out of its surroundings.
#pragma once

#include <cstdint>
#include <span>

#include "engine/edit/placement/upright_bounds.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// How much of the ground around a thing the rows cover that `bits` [N] do not label, in [0,1]: the mean
/// opacity, seen from straight above, of those at the height of its foot and below (a hat is worn above the
/// ground), in a ring from the thing itself to as far out as a figure of its size is high. 0 where nothing
/// stands.
double ground_cover(const GaussianSet& set, std::span<const std::uint8_t> bits, const UprightBounds& standing,
                    const Vec3& up, raster::Rasterizer& rasterizer);

/// Of all of a scene; of a large one some of its rows tell.
UprightBounds standing_of_scene(const GaussianSet& set, const Vec3& up);

/// The cover of the ground around all that rises out of the lower quarter of a scene, of which `whole` is
/// where it stands.
double ground_of_scene(const GaussianSet& set, const UprightBounds& whole, const Vec3& up,
                       raster::Rasterizer& rasterizer);

}  // namespace gse::edit
