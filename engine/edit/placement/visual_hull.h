// The space that a thing's outlines from several sides enclose (Laurentini 1994: the visual hull; space
// carving, Kutulakos and Seitz 2000), with some outlines wrong and some places hidden (views.md 17).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/math/camera.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// A thing as one view shows it.
struct HullView {
    Camera camera;
    Image inside;  // [H,W,1] in [0,1]: 1 = the pixel shows the thing
    Image surface =
        {};  // [H,W,1] depth along z of what else is there, 0 = nothing; empty = nothing hides the thing
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

/// Share of the views that see the point in which it is inside the outline; negative where too few see it: it
/// is out of the picture, or more than `slack` behind what else is there.
double hull_share(std::span<const HullView> views, const Vec3& point, double slack,
                  const HullParameters& parameters);

/// The part of the box that the outlines enclose; of several parts that do not touch, those of at least a
/// tenth of the largest.
VisualHull carve_hull(std::span<const HullView> views, const HullBox& box,
                      const HullParameters& parameters = {});

/// How well a hull fits the outlines: mean IoU, over the views, of the outline with where the hull is seen
/// before what else is there.
double hull_fit(std::span<const HullView> views, const VisualHull& hull);

/// Of the hulls with different `least_share`, the one that fits the outlines best: where outlines agree
/// little, a strict hull is smaller than all of them, and a loose one is larger where they agree.
VisualHull best_hull(std::span<const HullView> views, const HullBox& box, HullParameters parameters = {});

/// Where the hull is seen in a view.
Mask hull_mask(const VisualHull& hull, const Camera& camera);

/// A splat that is seen alike from everywhere. Rotation (w, x, y, z); colour is clamped to [0,1], opacity in
/// (0,1).
struct PlainSplat {
    Vec3 centre, deviation, colour;
    std::array<double, 4> rotation{1, 0, 0, 0};
    double opacity = 0.9;
};
void append_splat(GaussianData& data, const PlainSplat& splat);

/// One row per cube that lies at the hull's surface, and one for every few within: flat along the surface, of
/// the mean colour of the pictures that show it there. `opacity` in (0,1).
GaussianData hull_seeds(const VisualHull& hull, std::span<const HullView> views, int sh_degree,
                        double opacity = 0.9);

}  // namespace gse::edit
