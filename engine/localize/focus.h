// Moves the cameras in on a labelled region, so that a small model sees it large.
#pragma once

#include <cstdint>
#include <span>

#include "engine/scene/scene.h"

namespace gse::localize {

/// Share of the picture that a region fills.
struct FocusParameters {
    double fill = 0.62;    // share of the half field of view that the region's radius takes
    double trim = 0.03;    // share of the labelled rows cut off at either end of every axis
    double head_room = 0;  // how far above the region's middle the picture's lies, in extents of the region
    double least_change = 0.75;  // a new radius above this share of the old one is not worth new pictures
};

/// Orbit around the rows with bits[row] != 0. Centre and radius come from their trimmed bounds, the rest from
/// `base`. Returns `base` without a visible labelled row.
OrbitParameters focus_orbit(const GaussianSet& set, std::span<const std::uint8_t> bits,
                            const OrbitParameters& base, const FocusParameters& parameters = {});

/// True when moving from `base` to `focused` makes the region clearly larger in the pictures.
bool worth_refocusing(const OrbitParameters& base, const OrbitParameters& focused,
                      const FocusParameters& parameters = {});

}  // namespace gse::localize
