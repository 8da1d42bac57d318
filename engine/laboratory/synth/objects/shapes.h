// Solids and sheets the synthetic objects are built of, and their sampling into surface points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/random.h"
#include "engine/math/vec.h"

namespace gse::synth {

// Model space: y up, front towards -z, the object stands on y = 0 and is about 1 unit tall. World space (y
// down) is reached by a half turn about z (see generate.cpp).

/// Inputs of a surface's colour.
enum class Slot : std::uint8_t {
    Main,   // the material
    Pale,   // the material, lighter (muzzle, belly, stripes)
    Deep,   // the material, darker (roof, inner side)
    Fixed,  // always `colour` (eyes, windows)
    Trim,   // `colour` on a plainly coloured object, else the material (trunk, stem, beak)
    Glow,   // `colour` without any light or shade (flames)
};

struct Paint {
    Slot slot = Slot::Main;
    Vec3 colour{};
};

/// A point of a surface; `shape` indexes the list it was sampled from.
struct SurfacePoint {
    Vec3 position{};
    Vec3 normal{};
    double u = 0, v = 0;  // parameters in [0,1]
    double spacing = 0;   // mean distance to the neighbouring samples, model units
    std::uint32_t shape = 0;
};

/// Corner of the profile of a surface of revolution.
struct ProfilePoint {
    double radius = 0;
    double height = 0;
};

/// One primitive: a unit shape, scaled, rotated, moved.
struct Shape {
    enum class Kind : std::uint8_t { Sphere, Cube, Revolution, Sheet };

    Kind kind = Kind::Sphere;
    Vec3 centre{};
    Vec3 scale{1, 1, 1};
    Mat3 rotation = Mat3::identity();
    bool solid = true;   // points of other shapes inside it are dropped
    double density = 1;  // samples per area relative to the other shapes
    Paint paint;
    std::function<Paint(const SurfacePoint&)> paint_at;  // overrides `paint` where set
    std::vector<ProfilePoint> profile;                   // Revolution: outside from bottom to top
    std::function<Vec3(double u, double v)> sheet;       // Sheet: in model space (centre = its inner side)

    /// Position and outward unit normal at (u, v).
    SurfacePoint at(double u, double v) const;
    /// Parameters moved inwards so that the point keeps `margin` (model units) from sharp edges: a disc put
    /// there does not stick out over the edge.
    void keep_from_edges(double& u, double& v, double margin) const;
    /// True for points more than a hair inside the solid.
    bool contains(const Vec3& point) const;
    /// Radius of a sphere around `centre` that holds a solid shape.
    double bounding_radius() const;
};

using ShapeList = std::vector<Shape>;

Mat3 rotation_x(double radians);
Mat3 rotation_y(double radians);
Mat3 rotation_z(double radians);
/// Rotation that takes +y to the unit vector `axis`.
Mat3 rotation_to(const Vec3& axis);

Shape ellipsoid(const Vec3& centre, const Vec3& radii, Paint paint = {});
Shape box(const Vec3& centre, const Vec3& half, Paint paint = {});
/// Rounded limb from a to b with a radius at each end.
Shape capsule(const Vec3& a, const Vec3& b, double radius_a, double radius_b, Paint paint = {});
/// Closed truncated cone (cylinder, cone) from a to b.
Shape cone(const Vec3& a, const Vec3& b, double radius_a, double radius_b, Paint paint = {});
/// Ring around the y axis through `centre`.
Shape torus(const Vec3& centre, double ring_radius, double tube_radius, Paint paint = {});
/// Surface of revolution about the y axis through `centre`.
Shape revolution(const Vec3& centre, std::vector<ProfilePoint> profile, Paint paint = {});
/// Thin surface; normals point away from `inner`.
Shape sheet(const Vec3& inner, std::function<Vec3(double u, double v)> surface, Paint paint = {});

/// Spreads about `target` points evenly over the visible surface of `shapes`. Points inside another solid of
/// `shapes` or inside a solid of `others` are dropped, and so are points below the ground.
std::vector<SurfacePoint> sample_surface(std::span<const Shape> shapes, std::span<const Shape> others,
                                         int target, Random random);

}  // namespace gse::synth
