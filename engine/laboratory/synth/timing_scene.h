// A scene for timing: splats as trained scenes have them (flat, anisotropic, of very different sizes, half of
// them nearly transparent), at any count.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::synth {

/// Sphere, torus, box, cone and a small sphere on a ground disc of radius 7 under a dome of radius 14; SH
/// degree 3, up is +y. One count and seed give one scene.
Scene timing_scene(std::size_t count, std::uint64_t seed);

/// Cameras on one circle around it, 60 degrees wide.
std::vector<Camera> timing_cameras(int count, int width, int height);

}  // namespace gse::synth
