// Comparison of an edited scan with truth made by hand, on its splats and in pictures of it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "engine/laboratory/eval/real/real_suite.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/scene.h"

namespace gse::bench {

using Rows = std::vector<std::uint8_t>;  // [N] 0 or 1

/// Overlap of a label with the truth; each figure lies in [0,1], 0 where its divisor is 0.
struct Overlap {
    double iou = 0, recall = 0, precision = 0;

    nlohmann::ordered_json json() const;
};

/// Rows that are the thing, and rows that count neither way.
struct TruthRows {
    Rows thing, either;
};

/// Centres of the rows in the world of the scene's file, [N].
std::vector<Vec3> world_centres(const GaussianSet& set, const Vec3& offset);

/// Opacities of the rows, [N] in [0,1].
std::vector<double> opacities(const GaussianSet& set);

TruthRows truth_rows(const RealThing& thing, const std::vector<Vec3>& centres);

/// Overlap of the rows of a label with the truth; each row counts by its weight [N].
Overlap row_overlap(const Rows& label, const TruthRows& truth, const std::vector<double>& weight);

/// Overlap in pixels, pooled over pictures. Both lists have one mask per picture, of equal sizes.
Overlap seen_overlap(const std::vector<Mask>& label, const std::vector<Mask>& truth);

/// Rows of `after` whose position no row of `before` has, bit by bit.
Rows new_rows(const GaussianSet& after, const GaussianSet& before);

/// Share of new rows whose centre lies in a region.
struct PlaceShare {
    double opacity = 0;  // each row counts by its opacity
    double plain = 0;    // each row counts once
};

/// None where no row is new.
std::optional<PlaceShare> place_share(const TruthRegion& place, const GaussianSet& after, const Rows& added,
                                      const Vec3& offset);

/// Pictures of a task, squares of `RealPictureSide` pixels.
struct RealCameras {
    std::vector<Camera> sides;  // three
    Camera above;               // for masks alone
};
constexpr int RealPictureSide = 150;

/// Cameras around what a task is about, and where an addition goes. They stand in the world of the set.
/// `about`: rows of the thing, [N]; for kind "ground", and where nothing is named, all rows count.
RealCameras real_cameras(const RealScene& scene, const RealTask& task, const GaussianSet& set,
                         const Vec3& offset, const Rows& about);

/// Picture [H,W,3] of a set before grey.
Image real_picture(pipeline::Painter& painter, const GaussianSet& set, const SceneInfo& info,
                   const Camera& camera);

/// Masks of where rows [N] are what is seen, one per side and one from above. Opacities count as they are,
/// also in scenes that were trained with antialiasing.
std::vector<Mask> seen_rows(pipeline::Painter& painter, const GaussianSet& set, const Rows& rows,
                            const RealCameras& cameras);

/// Pixels that visibly change, per pixel of the truth in all masks.
struct SeenChange {
    double in_truth = 0, spill = 0;  // within the truth, and beside it
};

/// Change between the pictures of the sides, where a channel differs by more than a tenth of its range.
/// `truth`: masks as seen_rows() makes them. Its last one counts among the truth's pixels alone.
SeenChange seen_change(const std::vector<Image>& before, const std::vector<Image>& after,
                       const std::vector<Mask>& truth);

/// Quantile of values that are finite, between the two nearest; 0 for none. Reorders the values.
double quantile_of(std::vector<double>& values, double share);

}  // namespace gse::bench
