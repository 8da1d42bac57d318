// True scenes of edits that remove, move, turn, resize or copy, and how exactly rows followed a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/laboratory/eval/eval_suite.h"
#include "engine/raster/rasterizer.h"

namespace gse::bench {

/// Rows that belong together: of a set before, and of one after.
using RowPairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Largest errors of rows against a map, computed in double precision without the editor's own code.
struct MapError {
    double position = 0;    // world units
    double covariance = 0;  // of the largest entry of the rows' covariances
    double colour = 0;      // of spherical harmonics to degree 1: coefficient
    void add(const MapError& other);
};

/// Errors of the second of each pair against `map` of the first. Both sets are of SH degree 0 or 1.
MapError map_error(const GaussianSet& before, const GaussianSet& after, const RowPairs& pairs,
                   const synth::Placing& map);

/// Shift of `map` that fits the pairs best.
Vec3 fitted_shift(const GaussianSet& before, const GaussianSet& after, const RowPairs& pairs,
                  const synth::Placing& map);

/// Rows under a map. Of SH degree 0 or 1.
GaussianSet placed(const GaussianSet& rows, const synth::Placing& map);

/// Sets of one SH degree behind each other.
GaussianSet joined_sets(std::span<const GaussianSet> sets);

/// Axes of who looks at the front of a thing of the synthetic world: right, up, towards him. World space.
struct FrontAxes {
    Vec3 right, up{0, -1, 0}, forward;
};
FrontAxes front_axes(const synth::SceneSpec& spec);

/// Bounds of rows along the axes, without the outermost hundredth on either side of each.
struct ThingExtent {
    Vec3 size;  // right, up, forward
    Vec3 foot;  // world: under the middle, on the ground
    double longest() const;
};
ThingExtent extent_of(const GaussianSet& thing, const FrontAxes& axes);

/// Map of the thing itself that the case asks for.
synth::Placing asked_map(const EvalCase& edit, const ThingExtent& thing, const FrontAxes& axes);

/// Scene of a case with colours of the object that depend on the direction: SH degree 1.
synth::SynthScene directional_scene(const synth::SceneSpec& spec);

/// [N] 1 for rows of the ground that the object's shadow darkens, here or where it goes.
std::vector<std::uint8_t> shadowed_rows(const synth::SynthScene& scene,
                                        const std::vector<synth::Placing>& places = {});

/// Scene without the ground that no view of a scan around the thing shows.
synth::SynthScene scanned(synth::SynthScene scene, raster::Rasterizer& rasterizer);

}  // namespace gse::bench
