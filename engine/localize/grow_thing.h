// A whole thing from one point on it: what is linked with the point and apart from what it stands on.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/localize/voxel_grid.h"

namespace gse::localize {

/// Point that was clicked.
struct GrowRequest {
    Vec3 seed{};            // world units
    Vec3 up{0, -1, 0};      // of the world
    double extent = 1;      // height of the picture at the seed, world units: how fine the thing is looked at
    bool ground = false;    // the seed lies on the ground, which is what is meant
    bool part = false;      // a part of what is linked is meant
    double voxel_size = 1;  // of the usual one
};

/// Rows of a thing, and what it was separated from.
struct GrownThing {
    std::vector<std::uint8_t> rows;  // [N] 1 for the thing
    bool from_support = false;       // from what it stands on
    bool from_above = false;         // from what stands on it
    bool from_thread = false;        // from what hangs on it, or what it hangs on
    bool from_whole = false;         // from the rest of what it is a part of
};

/// Grows a thing around the seed, on all its sides (METHOD.md, Things from a click). Voxels linked with the
/// seed are taken, up to the layers where a thing stands on another (support_layers.h). Nothing is labelled
/// where nothing is solid near the seed.
GrownThing grow_thing(const GaussianSpans& gaussians, const GrowRequest& request);

/// Seed on the ground of a scene within `radius` of `centre`: on the lowest of its large flats, where
/// something stands on it. Nothing where there is none.
std::optional<Vec3> ground_seed(const GaussianSpans& gaussians, const Vec3& centre, double radius,
                                const Vec3& up);

/// Seed of the largest thing within `radius` of `centre` that stands alone: on the highest support of the
/// scene, or without one. Nothing where nothing is solid.
std::optional<Vec3> largest_thing(const GaussianSpans& gaussians, const Vec3& centre, double radius,
                                  const Vec3& up);

}  // namespace gse::localize
