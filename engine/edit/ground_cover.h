// Whether a thing stands on anything, or was cut out of its surroundings.
#pragma once

#include <cstdint>
#include <span>

#include "engine/edit/standing.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// How much of the ground around a thing the rows cover that `bits` [N] do not label, in [0,1]: the mean opacity, seen from straight above, of
/// those at the height of its foot and below (a hat is worn above the ground), in a ring from the thing itself to as far out as a figure of its
/// size is high. 0 where nothing stands.
double ground_cover(const GaussianSet& set, std::span<const std::uint8_t> bits, const Standing& standing, const Vec3& up, raster::Rasterizer& rasterizer);

/// The same of all that rises out of a scene's lower quarter: how much ground the scene has.
double ground_of_scene(const GaussianSet& set, const Standing& whole, const Vec3& up, raster::Rasterizer& rasterizer);

}  // namespace gse::edit
