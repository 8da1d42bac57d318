// A loaded scene: the Gaussians, facts of its file, labels, and viewpoints.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"
#include "engine/scene/origin/extra_columns.h"

namespace gse {

/// A named viewpoint. `distorted`: the source camera had lens distortion, so it is a viewpoint only.
struct View {
    std::string name;
    Camera camera;
    bool distorted = false;
};

/// One named label over the rows of a set: a weight in [0,1] and, after thresholding, a bit per row. Another
/// threshold recomputes the bits, never the weights.
struct Label {
    std::string name;
    std::shared_ptr<const std::vector<float>> weight;       // [N]
    std::shared_ptr<const std::vector<std::uint8_t>> bits;  // [N] 0 or 1
};

/// The named labels of a scene.
struct LabelSet {
    std::vector<Label> labels;
};

/// bits[row] = weight[row] > threshold.
Label make_label(std::string name, std::vector<float> weight, float threshold);

/// Facts of the file (or the generator) beside the Gaussians.
struct SceneInfo {
    std::string format;                 // name of a scene format ("spz"), or "synthetic"
    Vec3 up{0, -1, 0};                  // world up; 3DGS scenes follow COLMAP, -y up
    bool up_known = false;              // true when the file stated it
    bool up_unsure = false;             // true when neither cameras nor splats tell it: ask
    bool antialiased = false;           // trained with opacity compensation
    Vec3 offset{};                      // position in the file's world = position here + offset
    bool activated = false;             // opened as a file of sizes and opacities, see ReadingOptions
    bool looks_activated = false;       // holds what looks like sizes and opacities, not logs and logits
    std::vector<std::string> warnings;  // what was odd but survivable, one sentence each
    std::vector<std::string> lists;     // columns of the file that hold lists, which no file of ours keeps
};

struct Scene {
    GaussianSet gaussians;
    SceneInfo info;
    LabelSet labels;
    ExtraColumns extra = {};  // [gaussians.size()] each
};

/// Counts of possible defects of a scene. Printed by `info`, shown by the window.
struct SceneStatistics {
    std::size_t count = 0;
    std::size_t nan_rows = 0;  // any NaN in any attribute
    // Any infinity except a legal +-inf opacity logit or -inf log-scale, or a value that nothing can be
    // computed with (a position of 1e30, a colour of 1e10)
    std::size_t infinite_rows = 0;
    std::size_t giant_rows = 0;            // largest standard deviation above the robust scene radius
    std::size_t invisible_rows = 0;        // opacity below 1/255
    std::size_t visible_rows = 0;          // that can be drawn, with an opacity of 1/255 or more
    std::size_t haze_rows = 0;             // visible ones far around the scene, faint or scattered
    std::size_t sky_rows = 0;              // visible ones on a shell far around the scene
    std::size_t zero_quaternion_rows = 0;  // |q| < 1e-8
    Vec3 bounds_low{}, bounds_high{};      // over finite positions
    // 2nd to 98th percentile of visible finite rows that are neither haze nor sky
    Vec3 robust_low{}, robust_high{};
    double mean_opacity = 0;
};

SceneStatistics compute_statistics(const GaussianSet& set);

/// Orbit that frames the robust bounds of the scene. `up` is the world's up direction.
OrbitParameters fit_orbit(const SceneStatistics& statistics, const Vec3& up);

/// `count` views evenly spaced on the orbit, at two alternating elevations so that tops are seen.
std::vector<View> orbit_views(const OrbitParameters& orbit, int count, int width, int height);

/// Byte per row [N]: 1 for rows that can be drawn, 0 for rows with a NaN, a meaningless infinity or an absurd
/// value.
std::vector<std::uint8_t> usable_rows(const GaussianSet& set);

/// The rows that can be drawn: no NaN, no illegal infinity, no absurd value.
GaussianSet drop_unusable(const GaussianSet& set);

/// The set with rows that cannot be drawn made invisible and finite. Pictures, losses and figures use it; the
/// scene keeps its own values. Shares all arrays if every row can be drawn.
GaussianSet drawable(const GaussianSet& set);

}  // namespace gse
