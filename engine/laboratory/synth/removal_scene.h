// Scenes with a thing to remove, as a scan would hold them, and the true scene without it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::synth {

/// A thing on or before textured surfaces. Row order of `scene`: surroundings, thing.
struct RemovalScene {
    std::string name;
    GaussianSet scene;                // with the thing, its shadow in the colours
    GaussianSet truth;                // the surroundings alone, without the shadow
    std::vector<std::uint8_t> thing;  // [N] of `scene`
    Vec3 up{0, -1, 0};
    OrbitParameters orbit;      // frames the place of the thing
    double widest_azimuth = 0;  // cameras stand within this of azimuth 0, radians

    std::size_t surroundings() const { return truth.size(); }
    /// Camera at a share in [0,1] of the azimuths.
    Camera camera(double share, double elevation, int width, int height) const;
};

/// Kinds of scenes: things on grounds, at the edge of a table, before a wall, in a corner, half behind
/// another thing, on a mound, on a plinth.
const std::vector<std::string>& removal_scene_names();

/// Scene of a kind with about `gaussians` rows. Throws Error for an unknown kind.
RemovalScene removal_scene(const std::string& name, std::uint64_t seed, int gaussians = 12000);

/// A drawn thing of a height of about `size` that stands at a place of another scene, which is the truth.
RemovalScene removal_scene_on(const GaussianSet& surroundings, const Vec3& up, const Vec3& place, double size,
                              std::uint64_t seed);

}  // namespace gse::synth
