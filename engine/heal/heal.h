// Removing a thing from a scene and healing the hole that it leaves (METHOD.md, Removing and healing).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/scene/gaussian_set.h"

namespace gse::heal {

struct HealSettings {
    bool held_parts = true;
    bool shadow = true;
    double reach = 0.12;
    std::uint64_t seed = 1;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("held_parts", self.held_parts, "Also remove what only the thing held.");
        f("shadow", self.shadow, "Light the thing's shadow on the surfaces around again.");
        f("reach", self.reach,
          "Distance from where the thing was at which holes are still filled, in sizes of it.", Range{0, 2});
        f("seed", self.seed, "Seed of the planes and the texture.");
    }
};

struct HealInput {
    const GaussianSet& scene;
    std::span<const std::uint8_t> thing;  // [N] 1 = must go
    Vec3 up{0, -1, 0};                    // world up
    JobControl control = {};
};

/// Surface that the thing stood on or hid.
struct HealedSurface {
    Vec3 origin, normal;     // plane; the normal is on the thing's side
    double cell = 0;         // side of a cell, world units
    double healed_area = 0;  // world units squared
    double open_area = 0;    // that may belong to it but was left open
    std::size_t rows = 0;    // of Healed::added
    bool copied = false;     // false = filled with plain colour, since there was too little to copy from
};

/// Light on the ground around a thing's foot, as its shadow leaves it.
struct Shadow {
    struct Row {
        Vec3 at;       // world
        Vec3 gain{1};  // factor per channel that lights the row again; 1 = it is in no shadow
    };
    std::vector<Row> rows;
    double cell = 0;  // distance between neighbours, world units
};

struct Healed {
    std::vector<std::uint8_t> removed;  // [N] the thing, what it held, its shadow, garbage beneath it
    GaussianData added;                 // of the scene's SH degree
    std::vector<HealedSurface> surfaces;
    // Rows of `removed` beside the thing: held parts, rows that were lit again, remains in foot and holes.
    std::size_t carried = 0, shadow = 0, cleared = 0;
    Shadow shadow_measured;  // of the surface that it stood on; without rows = none was looked for
    std::string open;        // sentence on what stays open; empty = nothing
};

/// Removes the rows of `thing` and continues the surfaces that it stood on or hid. Other rows stay as they
/// are. Equal inputs give equal results. Throws Error for a label without rows or of another length, an up of
/// zero, and when stopped.
Healed remove_and_heal(const HealInput& input, const HealSettings& settings = {});

/// The rows of `thing` with those that only it held, which move as it does: [N] 0 or 1. Throws Error as
/// above.
std::vector<std::uint8_t> with_held_parts(const HealInput& input);

/// Removes the rows of `thing`, which may be none, and fills the holes of the surfaces inside a ball. Throws
/// Error as above.
Healed heal_region(const HealInput& input, const Vec3& centre, double radius,
                   const HealSettings& settings = {});

/// Set without the removed rows, then the added ones.
GaussianSet healed_set(const GaussianSet& scene, const Healed& healed);

}  // namespace gse::heal
