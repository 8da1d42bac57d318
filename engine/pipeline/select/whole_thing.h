// The whole of a thing that words found most of, by its shape.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::pipeline {

/// Rows [N] of the thing that `label` [N] is most of: what is linked with its middle and apart from what it
/// stands on (localize::grow_thing). Empty where label and shape tell of different things. `orbit`: views of
/// the scene, world units. `part`: the thing is a part of what it is linked with, as a hat is of its wearer
/// (METHOD.md, The whole of a thing).
std::vector<std::uint8_t> whole_thing(const GaussianSet& set, const std::vector<std::uint8_t>& label,
                                      const OrbitParameters& orbit, bool part = false);

}  // namespace gse::pipeline
