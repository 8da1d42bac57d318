// Accessories, built large around an object's anchor: hat, crown, sunglasses, scarf, flames, wings.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/laboratory/synth/objects/materials.h"
#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr double FullTurn = 2 * std::numbers::pi;

ShapeList make_hat(const Anchor& anchor, Random& random) {
    const double brim = std::max(0.33, anchor.head_radius * random.uniform(1.4, 1.55));
    const double crown = brim * random.uniform(0.6, 0.68);
    const double height = random.uniform(0.28, 0.34);
    const Vec3 base = anchor.top + Vec3{0, -0.04, 0};
    ShapeList shapes;
    shapes.push_back(revolution(
        base,
        {{0, -0.01}, {brim * 0.9, -0.01}, {brim, 0.012}, {brim * 0.97, 0.035}, {crown, 0.04}, {0, 0.04}},
        Main));
    shapes.push_back(revolution(base,
                                {{0, 0.02},
                                 {crown, 0.03},
                                 {crown * 0.98, height * 0.5},
                                 {crown * 0.92, height * 0.9},
                                 {crown * 0.75, height},
                                 {0, height}},
                                Main));
    shapes.push_back(
        revolution(base, {{0, 0.035}, {crown + 0.014, 0.036}, {crown + 0.012, 0.105}, {0, 0.106}}, Deep));
    return shapes;
}

ShapeList make_crown(const Anchor& anchor, Random& random) {
    const double radius = std::max(0.22, anchor.head_radius * random.uniform(0.98, 1.08));
    const double band = 0.11;
    const double height = random.uniform(0.3, 0.35);
    constexpr int Points = 6;
    const double turn = 0.5 / Points;
    const Vec3 base = anchor.top + Vec3{0, -0.05, 0};
    ShapeList shapes;
    shapes.push_back(sheet(
        base,
        [=](double u, double v) {
            const double phase = u * Points - std::floor(u * Points);
            const double top = band + (height - band) * std::abs(2 * phase - 1);
            const double flare = 1 + 0.16 * v * top / height;
            const double angle = FullTurn * (u + turn - 0.25);
            return base + Vec3{radius * flare * std::cos(angle), top * v, radius * flare * std::sin(angle)};
        },
        Main));
    shapes.push_back(revolution(
        base, {{radius - 0.02, 0}, {radius + 0.025, 0}, {radius + 0.03, 0.05}, {radius + 0.005, 0.055}},
        Deep));
    constexpr std::array<Vec3, 3> Gems{Vec3{0.9, 0.05, 0.1}, Vec3{0.1, 0.3, 0.95}, Vec3{0.05, 0.75, 0.3}};
    for (int i = 0; i < Points; ++i) {
        const double tip = FullTurn * (static_cast<double>(i) / Points + turn - 0.25);
        const double flare = radius * 1.16;
        shapes.push_back(ellipsoid(base + Vec3{flare * std::cos(tip), height, flare * std::sin(tip)},
                                   {0.03, 0.03, 0.03}, Pale));
        const double between = tip + 0.5 * FullTurn / Points;
        const double gem = radius * 1.03 + 0.01;
        Shape stone =
            ellipsoid(base + Vec3{gem * std::cos(between), 0.085, gem * std::sin(between)},
                      {0.042, 0.04, 0.042}, {Slot::Fixed, Gems[static_cast<std::size_t>(i) % Gems.size()]});
        stone.density = 2;
        shapes.push_back(stone);
    }
    return shapes;
}

ShapeList make_sunglasses(const Anchor& anchor, Random& random) {
    const double half = std::max(anchor.eye_half, 0.115);
    const double radius = half * random.uniform(0.95, 1.02);
    const Paint glass{Slot::Fixed, {0.02, 0.02, 0.04}};
    const Vec3 front = anchor.eyes + Vec3{0, 0, -0.035};
    ShapeList shapes;
    for (const double side : {-1.0, 1.0}) {
        const Vec3 lens_at = front + Vec3{side * half * 1.08, 0, 0};
        Shape frame = ellipsoid(lens_at, {radius * 1.06, radius * 0.9, 0.035}, Main);
        shapes.push_back(frame);
        Shape lens = ellipsoid(lens_at + Vec3{0, 0, -0.022}, {radius * 0.82, radius * 0.68, 0.03}, glass);
        lens.density = 2;
        lens.paint_at = [glass](const SurfacePoint& point) {
            const double sky = smooth_step(0.6, 0.85, point.v);  // the upper part mirrors a little sky
            return Paint{Slot::Fixed, mix(glass.colour, {0.22, 0.26, 0.36}, sky)};
        };
        shapes.push_back(lens);
        const Vec3 hinge = front + Vec3{side * (half * 1.08 + radius * 0.9), 0.03, 0.01};
        const Vec3 ear{side * std::max(hinge.x * side, anchor.head_radius + 0.03), hinge.y + 0.01,
                       hinge.z + anchor.face_depth};
        shapes.push_back(capsule(hinge, ear, 0.026, 0.022, Main));
    }
    shapes.push_back(
        capsule(front + Vec3{-half * 0.4, 0.02, 0}, front + Vec3{half * 0.4, 0.02, 0}, 0.026, 0.026, Main));
    return shapes;
}

ShapeList make_scarf(const Anchor& anchor, Random& random) {
    const double thick = random.uniform(0.085, 0.1);
    const double side = random.uniform() < 0.5 ? -1 : 1;
    const double hang = random.uniform(0.3, 0.38);
    const double rx = std::max(anchor.neck_x + thick * 0.5, 0.19);
    const double rz = anchor.neck_z + thick * 0.5;
    ShapeList shapes;
    // A ring of its own width and depth whose tube stays round: the profile is bent in model space.
    Shape ring = sheet(
        anchor.neck,
        [=](double u, double v) {
            const double a = FullTurn * u;
            const double t = FullTurn * v;
            const double out = thick * std::cos(t);
            return anchor.neck +
                   Vec3{(rx + out) * std::cos(a), 1.05 * thick * std::sin(t), (rz + out) * std::sin(a)};
        },
        Main);
    ring.paint_at = [](const SurfacePoint& point) {
        return std::fmod(point.u * 12, 1.0) < 0.3 ? Pale : Main;
    };
    shapes.push_back(ring);
    const double front = anchor.neck.z - rz - thick * 0.75;
    const Vec3 knot{side * std::min(0.1, rx * 0.6), anchor.neck.y - 0.02, front};
    shapes.push_back(ellipsoid(knot, {0.085, 0.085, 0.06}, Main));
    const double bottom = std::max(0.03, knot.y - hang);
    for (const double spread : {-0.055, 0.06}) {
        const double low = spread > 0 ? bottom : bottom + 0.09;
        const Vec3 half{0.06, 0.5 * (knot.y - low), 0.026};
        Shape end = box({knot.x + side * spread * 1.3, 0.5 * (knot.y + low), front - 0.02}, half, Main);
        end.rotation = rotation_z(side * spread * 2.5);
        end.paint_at = [](const SurfacePoint& point) {
            return std::fmod(point.v * 3.2, 1.0) < 0.3 ? Pale : Main;
        };
        shapes.push_back(end);
    }
    return shapes;
}

/// One tongue of fire: a leaning, twisted teardrop from deep orange to yellow.
Shape tongue(const Vec3& foot, double width, double height, double lean_x, double lean_z) {
    Shape shape = sheet(foot, [=](double u, double v) {
        const double radius = width * std::pow(1 - v, 0.8) * (0.55 + 1.1 * std::sqrt(v) * (1 - 0.4 * v));
        const double sway = 0.12 * height * std::sin(5.0 * v + 9.0 * foot.x + 7.0 * foot.z);
        return foot + Vec3{radius * std::cos(FullTurn * u) + lean_x * v * v + sway * v, height * v,
                           radius * std::sin(FullTurn * u) + lean_z * v * v};
    });
    shape.paint_at = [](const SurfacePoint& point) {
        const double streak = 0.5 + 0.5 * std::sin(FullTurn * point.u * 3);
        const Vec3 hot = mix({1.0, 0.93, 0.25}, {1.0, 0.72, 0.05}, streak);
        const Vec3 colour = mix(hot, {0.98, 0.25, 0.02}, smooth_step(0.1, 0.75, point.v + 0.2 * streak));
        return Paint{Slot::Glow, colour};
    };
    return shape;
}

ShapeList make_flames(const Anchor& anchor, Random& random) {
    ShapeList shapes;
    constexpr int Ring = 9;
    for (int i = 0; i < Ring; ++i) {
        const double angle = FullTurn * (i + random.uniform(-0.2, 0.2)) / Ring;
        const double away = std::cos(angle);  // 1 = behind the object
        const Vec3 foot{(anchor.body_radius + 0.05) * std::sin(angle), 0.0,
                        (anchor.body_depth + 0.05) * away};
        const double height = away < -0.3 ? random.uniform(0.22, 0.34) : random.uniform(0.5, 0.85);
        shapes.push_back(tongue(foot, random.uniform(0.09, 0.12), height, -0.25 * foot.x, -0.25 * foot.z));
    }
    for (int i = 0; i < 3; ++i) {
        const Vec3 foot = anchor.top + Vec3{(i - 1) * anchor.head_radius * 0.75, -0.09, 0.03};
        shapes.push_back(tongue(foot, 0.11, i == 1 ? random.uniform(0.36, 0.44) : random.uniform(0.22, 0.3),
                                0.05 * (i - 1), 0.05));
    }
    return shapes;
}

ShapeList make_wings(const Anchor& anchor, Random& random) {
    const double span = random.uniform(0.24, 0.32);
    const double lift = random.uniform(0.2, 0.3);
    ShapeList shapes;
    constexpr int Feathers = 5;
    for (const double side : {-1.0, 1.0}) {
        const Vec3 root = anchor.back + Vec3{side * 0.05, 0, 0.03};
        for (int i = 0; i < Feathers; ++i) {
            const double t = static_cast<double>(i) / (Feathers - 1);
            const double reach = std::clamp(anchor.body_radius + span, 0.55, 0.68) * (1 - 0.45 * t);
            const double angle = 0.75 + lift - 1.35 * t;  // from the horizontal, upper feathers first
            const Vec3 direction = normalized({side * std::cos(angle), std::sin(angle), 0.25});
            Shape feather = ellipsoid(root + direction * (0.5 * reach), {0.1, 0.52 * reach, 0.028},
                                      i % 2 == 0 ? Main : Deep);
            // Flat side towards the front: the local z axis is as near to -z as the direction allows.
            const Vec3 flat = normalized(Vec3{0, 0, -1} + direction * direction.z);
            const Vec3 across = cross(direction, flat);
            feather.rotation = Mat3::from_columns(across, direction, flat);
            shapes.push_back(feather);
        }
    }
    return shapes;
}

}  // namespace

ShapeList make_accessory(const std::string& word, const Anchor& anchor, Random random) {
    if (word == "hat") return make_hat(anchor, random);
    if (word == "crown") return make_crown(anchor, random);
    if (word == "sunglasses") return make_sunglasses(anchor, random);
    if (word == "scarf") return make_scarf(anchor, random);
    if (word == "flames") return make_flames(anchor, random);
    if (word == "wings") return make_wings(anchor, random);
    if (word == "cape") return make_cape(anchor, random);
    if (word == "beard") return make_beard(anchor, random);
    if (word == "horns") return make_horns(anchor, random);
    if (word == "helmet") return make_helmet(anchor, random);
    if (word == "halo") return make_halo(anchor, random);
    if (word == "backpack") return make_backpack(anchor, random);
    if (word == "headphones") return make_headphones(anchor, random);
    GSE_CHECK(word == "necklace");
    return make_necklace(anchor, random);
}

}  // namespace gse::synth
