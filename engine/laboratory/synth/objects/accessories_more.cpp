// More accessories: cape, beard, horns, helmet, halo, backpack, headphones, necklace.
#include <algorithm>
#include <cmath>

#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr double Whole = 6.283185307179586;
constexpr Paint Gilt{Slot::Fixed, {0.95, 0.72, 0.15}};

/// Horizontal ring with its own width and depth and a tube of height `high` and thickness `thick`.
Shape oval_ring(const Vec3& centre, double rx, double rz, double thick, double high, Paint paint) {
    return sheet(
        centre,
        [=](double u, double v) {
            const double a = Whole * u;
            const double out = thick * std::cos(Whole * v);
            return centre +
                   Vec3{(rx + out) * std::cos(a), high * std::sin(Whole * v), (rz + out) * std::sin(a)};
        },
        paint);
}

/// Ellipse-shaped tube in the plane through the y axis and `across`; v runs from angle `from` to `to`,
/// measured from straight up.
Shape arch(const Vec3& centre, const Vec3& across, double wide, double high, double from, double to,
           double thick, double half, Paint paint) {
    const Vec3 side = cross(across, {0, 1, 0});
    return sheet(
        centre,
        [=](double u, double v) {
            const double a = from + (to - from) * v;
            const double out = thick * std::cos(Whole * u);
            return centre + across * ((wide + out) * std::sin(a)) + Vec3{0, (high + out) * std::cos(a), 0} +
                   side * (half * std::sin(Whole * u));
        },
        paint);
}

}  // namespace

ShapeList make_cape(const Anchor& anchor, Random& random) {
    const double flare = random.uniform(0.08, 0.14);
    const double folds = std::floor(random.uniform(5, 8));
    const double hem = random.uniform(0.04, 0.09);
    const double neck_x = std::max(anchor.neck_x + 0.03, 0.15);
    const double neck_z = std::max(anchor.neck_z + 0.03, 0.1);
    const double start_y = std::max(anchor.neck.y + 0.06, anchor.back.y);
    const double start_z = anchor.neck.z + neck_z;
    const double fall_y = std::min(anchor.back.y + 0.07, start_y + 0.04);
    const double fall_z = std::max(anchor.back.z + 0.06, start_z);
    const double end_z = std::max(anchor.body_depth + 0.1, fall_z + 0.1);
    const double wide = std::clamp(anchor.body_radius + flare, 0.4, 0.54);
    const double side_end = 0.5 * (anchor.neck.z + anchor.back.z) + 0.06;
    ShapeList shapes;
    Shape cloth = sheet(
        {0, 0.4, anchor.neck.z},
        [=](double u, double v) {
            constexpr double Shoulder = 0.25;  // part of v from the neck to where the cloth falls
            const double first = std::min(v / Shoulder, 1.0);
            const double down = std::max(v - Shoulder, 0.0) / (1 - Shoulder);
            const double turn = 0.25 * Whole * down;
            const double y = start_y + (fall_y - start_y) * first -
                             (fall_y - hem) * (1 - std::pow(std::max(std::cos(turn), 0.0), 0.75));
            const double z =
                start_z + (fall_z - start_z) * first + (end_z - fall_z) * std::pow(std::sin(turn), 0.8);
            const double angle = 0.52 * Whole * (u - 0.5);
            const double half = neck_x + (wide - neck_x) * (0.45 * first + 0.55 * down);
            const double side_z = anchor.neck.z + (side_end - anchor.neck.z) * v;
            const double wave = 1 + 0.05 * v * std::sin(Whole * folds * u);
            const double drop = first * 0.05 * std::abs(std::sin(angle));
            return Vec3{wave * half * std::sin(angle), y - drop,
                        side_z + wave * (z - side_z) * std::cos(angle)};
        },
        Main);
    cloth.paint_at = [folds](const SurfacePoint& point) {
        if (point.v > 0.94) return Pale;
        return std::sin(Whole * folds * point.u) < -0.55 && point.v > 0.15 ? Deep : Main;
    };
    shapes.push_back(cloth);
    const Vec3 collar = anchor.neck + Vec3{0, 0.02, 0};
    shapes.push_back(oval_ring(collar, neck_x + 0.01, neck_z + 0.01, 0.055, 0.07, Main));
    const double front = collar.z - neck_z - 0.055;
    for (const double side : {-1.0, 1.0}) {
        Shape tip = ellipsoid({side * 0.09, collar.y - 0.04, front}, {0.09, 0.055, 0.035}, Main);
        tip.rotation = rotation_z(-side * 0.5);
        shapes.push_back(tip);
    }
    Shape clasp = ellipsoid({0, collar.y - 0.01, front - 0.03}, {0.05, 0.05, 0.035}, Gilt);
    clasp.density = 2;
    shapes.push_back(clasp);
    return shapes;
}

ShapeList make_beard(const Anchor& anchor, Random& random) {
    const double length = random.uniform(0.34, 0.42);
    const double half = std::max(anchor.eye_half * 1.35, anchor.head_radius * 0.8);
    const double curl = random.uniform(0.02, 0.07);
    const double drop = std::clamp(0.5 * (anchor.eyes.y - anchor.neck.y), 0.12, 0.16);
    const Vec3 mouth = anchor.eyes + Vec3{0, -drop, -0.04};
    const double bottom = std::max(0.05, mouth.y - length);
    ShapeList shapes;
    constexpr int Locks = 7;
    for (int i = 0; i < Locks; ++i) {
        const double t = 2.0 * i / (Locks - 1) - 1;
        const double away = t * t;
        const Vec3 root{t * half, mouth.y - 0.05 + 0.07 * away, mouth.z + 0.12 * away};
        const double low = bottom + (mouth.y - bottom) * 0.55 * away + (i % 2 == 0 ? 0.0 : 0.03);
        const Vec3 end{t * half * 0.68, low, mouth.z - 0.06 + 0.08 * away};
        shapes.push_back(capsule(root, end, 0.085, 0.05, i % 2 == 0 ? Main : Pale));
    }
    for (const double side : {-1.0, 1.0}) {
        const Vec3 cheek{side * half, mouth.y + 0.02, mouth.z + 0.12};
        const double temple_x = std::max(anchor.head_radius, half) + 0.02;
        const Vec3 temple{side * temple_x, anchor.eyes.y - 0.07, anchor.eyes.z + 0.75 * anchor.face_depth};
        shapes.push_back(capsule(cheek, temple, 0.08, 0.035, Main));
        const Vec3 middle = mouth + Vec3{side * 0.02, 0.03, -0.075};
        const Vec3 bend = mouth + Vec3{side * half * 0.6, 0.0, -0.05};
        const Vec3 tip = mouth + Vec3{side * half * 1.05, curl, -0.01};
        shapes.push_back(capsule(middle, bend, 0.05, 0.045, Pale));
        shapes.push_back(capsule(bend, tip, 0.045, 0.018, Pale));
    }
    return shapes;
}

ShapeList make_horns(const Anchor& anchor, Random& random) {
    const double size = random.uniform(0.72, 0.92);
    const double spread = random.uniform(0.24, 0.32) * size;
    const double base = std::max(0.08, anchor.head_radius * 0.34);
    const double root_x = std::max(0.12, anchor.head_radius * 0.72);
    constexpr int Pieces = 6;
    ShapeList shapes;
    for (const double side : {-1.0, 1.0}) {
        const Vec3 root = anchor.top + Vec3{side * root_x, -0.09, 0};
        Vec3 from = root;
        double thick = base;
        for (int i = 1; i <= Pieces; ++i) {
            const double t = static_cast<double>(i) / Pieces;
            const Vec3 to = root + Vec3{side * spread * std::sin(2.3 * t), 0.02 * t + 0.34 * size * t * t,
                                        -0.04 * std::sin(3.0 * t)};
            const double next = base * (1 - 0.85 * t);
            shapes.push_back(capsule(from, to, thick, next, i == Pieces ? Pale : i % 2 == 0 ? Deep : Main));
            from = to;
            thick = next;
        }
    }
    return shapes;
}

ShapeList make_helmet(const Anchor& anchor, Random& random) {
    const double close = std::max(0.24, anchor.head_radius * random.uniform(1.2, 1.26));
    const double extra = 0.75 * std::clamp(anchor.top.y - anchor.eyes.y - 0.2, 0.0, 0.17);
    const double rx = std::min(close + extra, std::max(close, anchor.body_radius));
    const double rz = std::clamp(anchor.top.z - anchor.eyes.z + 0.04, rx, 1.3 * rx);
    const double rim = std::clamp(anchor.eyes.y + 0.085, anchor.top.y - 0.24, anchor.top.y - 0.05);
    const double top = anchor.top.y + random.uniform(0.06, 0.09);
    const double crest = random.uniform(0.055, 0.075);
    const double flap = std::clamp(rim - anchor.eyes.y + 0.06, 0.1, 0.22);
    const Vec3 base{anchor.top.x, rim, anchor.top.z};
    ShapeList shapes;
    std::vector<ProfilePoint> profile{{0, 0}};
    for (int i = 0; i <= 8; ++i) {
        const double angle = 0.25 * Whole * i / 8;
        profile.push_back({std::cos(angle), std::sin(angle)});
    }
    Shape dome = revolution(base, profile, Main);
    dome.scale = {rx, top - rim, rz};
    shapes.push_back(dome);
    shapes.push_back(oval_ring(base, rx, rz, 0.03, 0.035, Deep));
    // Guard of the cheeks and the neck: open in front.
    shapes.push_back(sheet(
        base,
        [=](double u, double v) {
            const double a = 0.68 * Whole * (u - 0.5);
            const double low = flap * std::min(1.0, 6 * std::min(u, 1 - u) + 0.45);
            const double out = 1.01 + 0.06 * v;
            return base + Vec3{rx * out * std::sin(a), -low * v, rz * out * std::cos(a)};
        },
        Main));
    Shape peak = ellipsoid(base + Vec3{0, 0.0, -rz - 0.01}, {rx * 0.7, 0.022, 0.06}, Deep);
    peak.rotation = rotation_x(0.12);
    shapes.push_back(peak);
    shapes.push_back(
        arch(base, {0, 0, 1}, rz + 0.3 * crest, top - rim + 0.3 * crest, -1.0, 1.5, crest, 0.045, Deep));
    for (const double side : {-1.0, 1.0})
        shapes.push_back(
            ellipsoid(base + Vec3{side * (rx + 0.02), 0.0, -0.25 * rz}, {0.03, 0.045, 0.045}, Pale));
    return shapes;
}

ShapeList make_halo(const Anchor& anchor, Random& random) {
    const double radius = std::max(0.25, anchor.head_radius * random.uniform(1.12, 1.25));
    const double tilt = random.uniform(0.12, 0.22);
    const double tube = random.uniform(0.044, 0.052);
    const Vec3 centre = anchor.top + Vec3{0, random.uniform(0.1, 0.13), 0.01};
    Shape ring = torus(centre, radius, tube, Main);
    ring.rotation = rotation_x(-tilt);
    ring.paint_at = [](const SurfacePoint& point) { return point.normal.y > 0.75 ? Pale : Main; };
    return {ring};
}

ShapeList make_backpack(const Anchor& anchor, Random& random) {
    const double w = random.uniform(0.2, 0.24);
    const double h = random.uniform(0.19, 0.23);
    const double d = random.uniform(0.1, 0.13);
    // On a lying body the place for wings is on top of the back: the pack stands there.
    const bool lying = anchor.body_depth - anchor.back.z > 0.25;
    const double lowest = h + 0.04;
    const double y = lying ? anchor.back.y + h * 0.8 : anchor.back.y - 0.03;
    const Vec3 centre{0, std::max(lowest, y), anchor.back.z + (lying ? 0.06 : d + 0.01)};
    ShapeList shapes;
    shapes.push_back(box(centre, {w, h, d}, Main));
    Shape dome = ellipsoid(centre + Vec3{0, h - 0.01, 0}, {w, 0.07, d}, Main);
    shapes.push_back(dome);
    shapes.push_back(box(centre + Vec3{0, h * 0.62, d}, {w * 1.02, h * 0.34, 0.025}, Deep));
    shapes.push_back(box(centre + Vec3{0, -h * 0.42, d + 0.03}, {w * 0.72, h * 0.42, 0.05}, Pale));
    shapes.push_back(box(centre + Vec3{0, -h * 0.08, d + 0.035}, {w * 0.74, h * 0.1, 0.052}, Deep));
    Shape buckle = box(centre + Vec3{0, h * 0.34, d + 0.03}, {0.035, 0.035, 0.015}, Gilt);
    buckle.density = 2;
    shapes.push_back(buckle);
    const Vec3 roll = centre + Vec3{0, h + 0.085, 0};
    shapes.push_back(capsule(roll - Vec3{w, 0, 0}, roll + Vec3{w, 0, 0}, 0.065, 0.065, Deep));
    for (const double side : {-1.0, 1.0}) {
        shapes.push_back(box(centre + Vec3{side * (w + 0.02), -h * 0.5, 0}, {0.03, h * 0.4, d * 0.7}, Deep));
        const double shoulder_x = std::max(anchor.neck_x + 0.03, 0.15);
        const double front_x = std::max(anchor.neck_x * 0.75, 0.12);
        const double front_z = anchor.neck.z - std::max(anchor.neck_z * 0.85, 0.1) - 0.07;
        const Vec3 path[] = {
            {side * shoulder_x * 0.9, centre.y + h * 0.85, centre.z - d * 0.8},
            {side * shoulder_x, anchor.neck.y + 0.07, anchor.neck.z},
            {side * front_x, anchor.neck.y - 0.01, front_z},
            {side * (front_x + 0.03), std::max(0.05, anchor.neck.y - 0.25), front_z - 0.03},
            {side * (shoulder_x + 0.03), std::max(0.05, anchor.neck.y - 0.3), anchor.neck.z},
        };
        for (int i = 0; i < 4; ++i) shapes.push_back(capsule(path[i], path[i + 1], 0.036, 0.036, Deep));
    }
    return shapes;
}

ShapeList make_headphones(const Anchor& anchor, Random& random) {
    const double cup = random.uniform(0.13, 0.15);
    const double extra = 1.2 * std::clamp(anchor.top.y - anchor.eyes.y - 0.2, 0.0, 0.17);
    const double nearest = std::max(0.17, anchor.head_radius + 0.045);
    const double x = std::min(nearest + extra, std::max(nearest, anchor.body_radius));
    const double y = std::clamp(anchor.eyes.y - 0.02, anchor.top.y - 0.28, anchor.top.y - 0.14);
    const Vec3 middle{0, y, anchor.top.z};
    const double high = anchor.top.y + random.uniform(0.045, 0.07) - y;
    ShapeList shapes;
    shapes.push_back(
        arch(middle, {1, 0, 0}, x + 0.03, high, -0.25 * Whole, 0.25 * Whole, 0.035, 0.055, Main));
    shapes.push_back(arch(middle, {1, 0, 0}, x + 0.01, high - 0.02, -0.7, 0.7, 0.035, 0.07, Deep));
    for (const double side : {-1.0, 1.0}) {
        const Vec3 out{side, 0, 0};
        const Vec3 at = middle + out * x;
        shapes.push_back(cone(at - out * 0.035, at + out * 0.025, cup, cup * 1.05, Deep));
        shapes.push_back(cone(at + out * 0.02, at + out * 0.09, cup * 0.98, cup * 0.75, Main));
        Shape centre = cone(at + out * 0.08, at + out * 0.105, cup * 0.5, cup * 0.45, Pale);
        centre.density = 1.5;
        shapes.push_back(centre);
    }
    return shapes;
}

ShapeList make_necklace(const Anchor& anchor, Random& random) {
    const double bead = random.uniform(0.046, 0.054);
    const double drop = random.uniform(0.07, 0.11);
    const double rx = std::max(anchor.neck_x + 0.035, 0.15);
    const double rz = std::max(anchor.neck_z + 0.035, 0.1);
    const int beads = std::clamp(static_cast<int>(0.5 * Whole * (rx + rz) / (2.05 * bead)), 14, 28);
    ShapeList shapes;
    for (int i = 0; i < beads; ++i) {
        const double angle = Whole * (i + 0.5) / beads;
        const double front = 0.5 + 0.5 * std::cos(angle);
        const Vec3 at = anchor.neck + Vec3{rx * std::sin(angle), 0.02 - drop * front * front,
                                           -(rz + 0.03 * front) * std::cos(angle)};
        shapes.push_back(ellipsoid(at, {bead, bead, bead}, i % 2 == 0 ? Main : Pale));
    }
    const double z = anchor.neck.z - rz - 0.07;
    const double y = std::max(0.13, anchor.neck.y - drop - 0.12);
    shapes.push_back(capsule({0, y + 0.12, z + 0.02}, {0, y, z}, 0.025, 0.03, Deep));
    shapes.push_back(ellipsoid({0, y, z}, {0.1, 0.115, 0.04}, Main));
    Shape gem = ellipsoid({0, y, z - 0.025}, {0.06, 0.07, 0.035}, Deep);
    gem.density = 2;
    shapes.push_back(gem);
    return shapes;
}

}  // namespace gse::synth
