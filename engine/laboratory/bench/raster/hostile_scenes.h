// Small scenes that are hard on a rasterizer in single precision, each for one named reason.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/math/camera.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/gaussian_set.h"

namespace gse::bench {

struct HostileScene {
    GaussianData data;
    Camera camera;
    raster::Settings settings;
};

/// A reason why a scene is hard, by name ("needles") and in words.
struct HostileCause {
    std::string name, meaning;
};

/// All causes; the first is an ordinary scene, the last a mixture of the others.
const std::vector<HostileCause>& hostile_causes();

/// The scene of that cause and seed: the same on every machine. Throws Error (InvalidArgument) for an unknown
/// cause.
HostileScene hostile_scene(const std::string& cause, std::uint64_t seed);

}  // namespace gse::bench
