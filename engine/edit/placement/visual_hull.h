// Visual hull (Laurentini 1994): the space that an object's outlines from several sides enclose (METHOD.md,
// Visual hull). Some outlines may be wrong and some places hidden (space carving, Kutulakos and Seitz 2000).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// Object as one view shows it.
struct HullView {
    Camera camera;
    Image inside;  // [H,W,1] in [0,1]: 1 = the pixel shows the thing
    // [H,W,1] depth along z of what else is there, 0 = nothing; empty = nothing hides the thing.
    Image surface = {};
    Image picture = {};  // [H,W,3] the thing's colours; for hull_seeds()
};

/// World box.
struct HullBox {
    Vec3 low, high;
};

struct HullParameters {
    int cells = 5000;            // about as many are inside, whatever the thing's size
    double least_share = 0.75;   // of the views that see a place: so many have it inside
    double least_seen = 0.4;     // of all views: fewer that see a place cannot say that it is inside
    double least_framed = 0.75;  // of all views: where fewer have a place in their picture, outlines that its
                                 // border cuts off say nothing of it
    double level = 0.5;          // of an outline's value that counts as inside
};

/// Cubes whose centres are inside.
struct VisualHull {
    std::vector<Vec3> centres;  // world
    std::vector<Vec3> normals;  // unit, outwards; zero deep inside
    double side = 0;            // of a cube, world units
    bool empty() const { return centres.empty(); }
};

/// Share of the views that see the point in which it is inside the outline. Negative if too few see it. Views
/// do not see points out of the picture, or more than `slack` behind other splats.
double hull_share(std::span<const HullView> views, const Vec3& point, double slack,
                  const HullParameters& parameters);

/// Part of the box that the outlines enclose. Of several separate parts, those of at least a tenth of the
/// largest.
VisualHull carve_hull(std::span<const HullView> views, const HullBox& box,
                      const HullParameters& parameters = {});

/// Fit of a hull to the outlines: mean IoU, over the views, of the outline with the visible part of the hull.
double hull_fit(std::span<const HullView> views, const VisualHull& hull);

/// Best fitting hull among those with different `least_share`. If outlines agree little, a strict hull is
/// smaller than all of them. A loose one is larger where they agree.
VisualHull best_hull(std::span<const HullView> views, const HullBox& box, HullParameters parameters = {});

/// Mask of the hull's visible part in a view.
Mask hull_mask(const VisualHull& hull, const Camera& camera);

/// Splat that is seen alike from everywhere. Rotation is (w, x, y, z); colour is clamped to [0,1], opacity in
/// (0,1).
struct PlainSplat {
    Vec3 centre, deviation, colour;
    std::array<double, 4> rotation{1, 0, 0, 0};
    double opacity = 0.9;
};
void append_splat(GaussianData& data, const PlainSplat& splat);

/// One row per cube at the hull's surface, and one for every few within. Rows are flat along the surface and
/// have the mean colour of the pictures that show them. `opacity` in (0,1).
GaussianData hull_seeds(const VisualHull& hull, std::span<const HullView> views, int sh_degree,
                        double opacity = 0.9);

}  // namespace gse::edit
