// The ground of a synthetic scene: a textured disc with the object's shadow baked in.
#pragma once

#include <string>

#include "engine/laboratory/synth/objects/materials.h"

namespace gse::synth {

/// Points of the ground with their colours, in model space.
struct GroundSample {
    std::vector<SurfacePoint> points;
    std::vector<Vec3> colours;
};

constexpr double GroundRadius = 3.0;

/// About `target` samples of the ground named `word`; denser near the middle. `object` casts the shadow.
GroundSample make_ground(const std::string& word, int target, std::span<const SurfacePoint> object,
                         const Light& light, Random random);

}  // namespace gse::synth
