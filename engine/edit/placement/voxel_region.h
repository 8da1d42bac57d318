// Region of an object that is not in the scene yet, and the faint new splats it grows from (METHOD.md, Where
// something new goes).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/thread_pool.h"
#include "engine/edit/interfaces/voxels.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/language/lexicon.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// Inputs of the search for a region.
struct RegionSearch {
    const GaussianSet& gaussians;
    std::span<const std::uint8_t> source_bits;  // [N] rows of the thing the new one belongs to
    const std::vector<View>& views;
    std::span<const Mask> masks;    // per view; an empty mask does not vote
    std::span<const Image> depths;  // per view [H,W,1] depth of the surface, 0 = nothing there
    Vec3 up{0, -1, 0};
    Vec3 front{0, 0, -1};                                    // where the thing looks
    language::Relation relation = language::Relation::None;  // what the sentence says of the new thing's
                                                             // place: cells elsewhere do not count
    ThreadPool* threads = nullptr;                           // may be null
    UprightBounds standing{};                                // of the thing; not found = read off its rows
};

struct RegionParameters {
    int cells = 28;                 // along the longest side of the searched box
    double least_agreement = 0.5;   // share of the views that see the best cube that must cover it
    double lowest_agreement = 0.4;  // of all regions above which the one is taken that matches the masks best
    double level_step = 0.05;
    // Share of the views in which the cube is in the mask: few that see it prove little.
    double least_covered = 0.45;
    double least_seen = 0.2;    // share of the views in which the cube is not hidden behind the surface
    double most_volume = 0.35;  // of the searched box: a larger region means the maps agree on nothing
    int least_cells = 6;
    // Share of the largest connected part: smaller ones are dropped (flames above a wide cap are)
    double least_part = 0.1;
};

/// Votes a grid of cubes around the source with the masks; empty when the masks do not agree on a place.
VoxelRegion vote_region(const RegionSearch& search, const RegionParameters& parameters = {});

/// A place relative to the source: "top" (hat, crown), "front" (glasses), "neck" (scarf) or "around"
/// (flames).
VoxelRegion anchor_region(const RegionSearch& search, const std::string& place, int cells = 28);

/// Region of an object of that name by the relation, when nothing else tells it. Without a relation, its
/// usual place.
VoxelRegion usual_region(const RegionSearch& search, const std::string& thing, int cells = 28);

/// `count` round splats of neutral colour, spread over the region; sized by the room each has. `opacity` in
/// (0,1).
GaussianData seed_splats(const VoxelRegion& region, int count, int sh_degree, std::uint64_t seed,
                         double opacity = 0.1);

/// Pixels that the region covers in a view. With `depth` ([H,W,1] of the surface, 0 = nothing there), those
/// in which some of it lies before the surface, or a cube's side behind it.
Mask region_mask(const VoxelRegion& region, const Camera& camera, const Image* depth = nullptr);

}  // namespace gse::edit
