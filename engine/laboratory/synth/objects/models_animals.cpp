// More animals: rabbit, horse, elephant, pig, lion, penguin, owl, frog, turtle, dinosaur.
#include <cmath>
#include <numbers>
#include <span>

#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr Paint AnimalWhite{Slot::Fixed, {0.97, 0.96, 0.9}};
constexpr Paint AnimalInk{Slot::Fixed, {0.03, 0.03, 0.04}};
constexpr Paint AnimalPink{Slot::Fixed, {0.95, 0.45, 0.5}};
constexpr Paint AnimalMouth{Slot::Fixed, {0.6, 0.08, 0.1}};
constexpr Paint AnimalOrange{Slot::Trim, {1.0, 0.5, 0.03}};

/// A small mark that stays sharp: nose, nostril, claw.
Shape animal_mark(const Vec3& centre, const Vec3& radii, Paint paint = AnimalInk) {
    Shape shape = ellipsoid(centre, radii, paint);
    shape.density = 3;
    return shape;
}

Shape animal_oval(const Vec3& centre, const Vec3& radii, const Mat3& rotation, Paint paint) {
    Shape shape = ellipsoid(centre, radii, paint);
    shape.rotation = rotation;
    return shape;
}

/// Pointed cone squeezed to `flat` of its width along x or z.
Shape animal_point(const Vec3& a, const Vec3& b, double radius, const Vec3& flat, Paint paint) {
    Shape shape = cone(a, b, radius, 0.008, paint);
    shape.scale = flat;
    return shape;
}

struct AnimalJoint {
    Vec3 at{};
    double radius = 0;
};

/// Bent limb through the joints.
void animal_limb(ShapeList& shapes, std::span<const AnimalJoint> joints, Paint paint) {
    for (std::size_t i = 0; i + 1 < joints.size(); ++i)
        shapes.push_back(
            capsule(joints[i].at, joints[i + 1].at, joints[i].radius, joints[i + 1].radius, paint));
}

/// A thin dark smile on the front of an ellipsoid, `drop` below its middle, over `turn` to each side.
void animal_smile(ShapeList& shapes, const Vec3& centre, const Vec3& radii, double drop, double turn,
                  double thickness) {
    constexpr int Pieces = 6;
    Vec3 from{};
    for (int i = 0; i <= Pieces; ++i) {
        const double t = 2.0 * i / Pieces - 1;
        const double y = -drop * (1 - 0.55 * t * t);
        const double shrink = std::sqrt(1 - y * y / (radii.y * radii.y));
        const Vec3 to =
            centre + Vec3{radii.x * shrink * std::sin(turn * t), y, -radii.z * shrink * std::cos(turn * t)};
        if (i > 0) {
            shapes.push_back(capsule(from, to, thickness, thickness, AnimalInk));
            shapes.back().density = 4;
        }
        from = to;
    }
}

}  // namespace

Model make_rabbit(Random& random) {
    const double girth = random.uniform(0.92, 1.08);
    const double ear = random.uniform(0.19, 0.225);
    const double spread = random.uniform(0.26, 0.4);
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.27, 0.05}, {0.23 * girth, 0.27, 0.22 * girth}, Main));
    s.push_back(ellipsoid({0, 0.27, -0.08 * girth}, {0.15 * girth, 0.19, 0.11 * girth}, Pale));
    s.push_back(ellipsoid({0, 0.57, -0.05}, {0.22, 0.18, 0.19}, Main));
    s.push_back(animal_mark({0, 0.55, -0.25}, {0.035, 0.026, 0.025}, AnimalPink));
    s.push_back(box({0, 0.465, -0.235}, {0.032, 0.035, 0.015}, AnimalWhite));
    s.back().density = 3;
    add_eyes(s, {0, 0.625, -0.195}, 0.105, 0.056);
    for (const double side : {-1.0, 1.0}) {
        const Mat3 lean = rotation_z(-side * spread);
        const Vec3 along{side * std::sin(spread), std::cos(spread), 0};
        const Vec3 root{side * 0.12, 0.66, 0.06};
        s.push_back(animal_oval(root + along * ear, {0.075, ear, 0.05}, lean, Main));
        s.push_back(
            animal_oval(root + along * ear + Vec3{0, 0, -0.03}, {0.045, ear * 0.8, 0.035}, lean, Pale));
        s.push_back(ellipsoid({side * 0.07, 0.52, -0.19}, {0.085, 0.06, 0.065}, Pale));
        s.push_back(ellipsoid({side * 0.19 * girth, 0.15, 0.02}, {0.1, 0.15, 0.18}, Main));
        s.push_back(capsule({side * 0.14, 0.06, -0.06}, {side * 0.17, 0.055, -0.31}, 0.07, 0.065, Main));
        s.push_back(ellipsoid({side * 0.172, 0.065, -0.34}, {0.05, 0.05, 0.045}, Pale));
        s.push_back(capsule({side * 0.16, 0.38, -0.1}, {side * 0.075, 0.26, -0.23}, 0.06, 0.055, Main));
    }
    s.push_back(ellipsoid({0, 0.16, 0.05 + 0.25 * girth}, {0.1, 0.1, 0.1}, Pale));
    model.anchor = {.top = {0, 0.775, -0.03},
                    .head_radius = 0.2,
                    .eyes = {0, 0.625, -0.24},
                    .eye_half = 0.12,
                    .face_depth = 0.24,
                    .neck = {0, 0.43, -0.01},
                    .neck_x = 0.18,
                    .neck_z = 0.17,
                    .back = {0, 0.4, 0.22},
                    .body_radius = 0.31,
                    .body_depth = 0.34};
    return model;
}

Model make_horse(Random& random) {
    const double leg = random.uniform(0.4, 0.45);
    const double rear = random.uniform(0.24, 0.3);
    const double swing = random.uniform(-0.1, 0.1);
    const double spine = leg + 0.08;
    const double head = spine + 0.33;
    Model model;
    auto& s = model.shapes;
    s.push_back(capsule({0, spine, -0.1}, {0, spine + 0.01, rear}, 0.15, 0.155, Main));
    s.push_back(capsule({0, spine + 0.04, -0.14}, {0, head - 0.04, -0.3}, 0.13, 0.095, Main));
    s.push_back(ellipsoid({0, head, -0.35}, {0.13, 0.125, 0.14}, Main));
    s.push_back(capsule({0, head - 0.03, -0.4}, {0, head - 0.17, -0.55}, 0.105, 0.085, Main));
    s.push_back(ellipsoid({0, head - 0.185, -0.57}, {0.1, 0.085, 0.09}, Pale));
    add_eyes(s, {0, head + 0.035, -0.455}, 0.085, 0.044);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(animal_mark({side * 0.045, head - 0.165, -0.65}, {0.018, 0.022, 0.016}));
        s.push_back(animal_point({side * 0.085, head + 0.07, -0.33}, {side * 0.135, head + 0.25, -0.35},
                                 0.065, {1, 1, 0.7}, Main));
        for (const double z : {-0.15, rear + 0.04}) {
            const double step = z < 0 ? -0.03 : 0.03;
            s.push_back(
                capsule({side * 0.09, spine - 0.03, z}, {side * 0.1, leg * 0.5, z}, 0.08, 0.052, Main));
            s.push_back(
                capsule({side * 0.1, leg * 0.5, z}, {side * 0.1, 0.06, z + step}, 0.052, 0.046, Main));
            s.push_back(cone({side * 0.1, 0, z + step}, {side * 0.1, 0.1, z + step}, 0.072, 0.055, Deep));
        }
    }
    constexpr int Locks = 5;
    for (int i = 0; i < Locks; ++i) {
        const double t = static_cast<double>(i) / (Locks - 1);
        const Vec3 at{0, head + 0.09 - 0.33 * t, -0.26 + 0.24 * t};
        s.push_back(animal_oval(at, {0.06, 0.1, 0.085}, rotation_x(0.5), Deep));
    }
    s.push_back(animal_oval({0, head + 0.11, -0.41}, {0.055, 0.045, 0.085}, rotation_x(-0.6), Deep));
    const AnimalJoint tail[] = {{{0, spine + 0.1, rear + 0.13}, 0.045},
                                {{swing * 0.5, spine + 0.06, rear + 0.25}, 0.065},
                                {{swing, spine - 0.12, rear + 0.31}, 0.075},
                                {{swing, spine - 0.32, rear + 0.3}, 0.025}};
    animal_limb(s, tail, Deep);
    model.anchor = {.top = {0, head + 0.16, -0.28},
                    .head_radius = 0.14,
                    .eyes = {0, head + 0.035, -0.5},
                    .eye_half = 0.1,
                    .face_depth = 0.18,
                    .neck = {0, spine + 0.17, -0.22},
                    .neck_x = 0.12,
                    .neck_z = 0.13,
                    .back = {0, spine + 0.15, 0.0},
                    .body_radius = 0.24,
                    .body_depth = 0.5};
    return model;
}

Model make_elephant(Random& random) {
    const double ear = random.uniform(0.2, 0.235);
    const double curl = random.uniform(0.0, 0.14);
    const double girth = random.uniform(0.95, 1.08);
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.47, 0.15}, {0.26 * girth, 0.26, 0.34}, Main));
    s.push_back(ellipsoid({0, 0.74, -0.18}, {0.22, 0.215, 0.2}, Main));
    add_eyes(s, {0, 0.8, -0.345}, 0.11, 0.048);
    for (const double side : {-1.0, 1.0}) {
        const Mat3 open = rotation_y(side * -0.35) * rotation_z(side * 0.2);
        s.push_back(animal_oval({side * 0.34, 0.74, -0.08}, {ear, 0.25, 0.04}, open, Main));
        s.push_back(animal_oval({side * 0.34, 0.73, -0.105}, {ear * 0.74, 0.18, 0.032}, open, Pale));
        const AnimalJoint tusk[] = {{{side * 0.11, 0.63, -0.3}, 0.04},
                                    {{side * 0.145, 0.52, -0.44}, 0.034},
                                    {{side * 0.14, 0.53, -0.55}, 0.014}};
        animal_limb(s, tusk, AnimalWhite);
        for (const double z : {-0.04, 0.34}) {
            s.push_back(cone({side * 0.16, 0, z}, {side * 0.155, 0.4, z}, 0.12, 0.105, Main));
            for (const double toe : {-0.05, 0.05})
                s.push_back(animal_mark({side * 0.16 + toe, 0.035, z - 0.1}, {0.036, 0.036, 0.025}, Pale));
        }
    }
    const AnimalJoint trunk[] = {{{0, 0.7, -0.34}, 0.105},
                                 {{0, 0.54, -0.45}, 0.088},
                                 {{0, 0.38, -0.48}, 0.076},
                                 {{0, 0.26, -0.54}, 0.066},
                                 {{0, 0.23 + 0.4 * curl, -0.64}, 0.06},
                                 {{0, 0.28 + curl, -0.72}, 0.056}};
    animal_limb(s, trunk, Main);
    s.push_back(capsule({0, 0.55, 0.47}, {0, 0.34, 0.55}, 0.025, 0.02, Main));
    s.push_back(ellipsoid({0, 0.31, 0.555}, {0.04, 0.06, 0.04}, Deep));
    model.anchor = {.top = {0, 0.955, -0.17},
                    .head_radius = 0.21,
                    .eyes = {0, 0.8, -0.39},
                    .eye_half = 0.125,
                    .face_depth = 0.22,
                    .neck = {0, 0.6, -0.05},
                    .neck_x = 0.2,
                    .neck_z = 0.18,
                    .back = {0, 0.71, 0.15},
                    .body_radius = 0.32,
                    .body_depth = 0.5};
    return model;
}

Model make_pig(Random& random) {
    const double girth = random.uniform(0.93, 1.1);
    const double snout = random.uniform(0.115, 0.13);
    const double ear = random.uniform(0.15, 0.19);
    const double turn = random.uniform() < 0.5 ? -1 : 1;
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.38, 0.12}, {0.28 * girth, 0.27, 0.34}, Main));
    s.push_back(ellipsoid({0, 0.3, 0.12}, {0.24 * girth, 0.22, 0.3}, Pale));
    s.push_back(ellipsoid({0, 0.6, -0.23}, {0.26, 0.24, 0.21}, Main));
    s.push_back(cone({0, 0.55, -0.36}, {0, 0.545, -0.52}, snout * 1.08, snout, Pale));
    s.back().scale.z = 0.85;
    add_eyes(s, {0, 0.7, -0.385}, 0.115, 0.052);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(animal_mark({side * 0.046, 0.55, -0.52}, {0.026, 0.042, 0.018}));
        s.push_back(animal_point({side * 0.17, 0.76, -0.2}, {side * 0.25, 0.78 + ear, -0.27}, 0.1,
                                 {1, 1, 0.5}, Main));
        s.push_back(animal_point({side * 0.172, 0.77, -0.235}, {side * 0.24, 0.75 + ear, -0.285}, 0.06,
                                 {1, 1, 0.5}, Pale));
        for (const double z : {-0.08, 0.3}) {
            s.push_back(cone({side * 0.15, 0.05, z}, {side * 0.15, 0.3, z}, 0.082, 0.095, Main));
            s.push_back(
                cone({side * 0.15, 0, z - 0.005}, {side * 0.15, 0.075, z - 0.005}, 0.09, 0.085, Deep));
        }
    }
    Vec3 from{0, 0.44, 0.44};
    constexpr int Pieces = 9;
    for (int i = 1; i <= Pieces; ++i) {
        const double t = static_cast<double>(i) / Pieces;
        const double angle = 2 * std::numbers::pi * 1.4 * t;
        const Vec3 to{turn * 0.075 * std::sin(angle), 0.515 - 0.075 * std::cos(angle), 0.44 + 0.17 * t};
        s.push_back(capsule(from, to, 0.03, 0.028, Main));
        from = to;
    }
    model.anchor = {.top = {0, 0.835, -0.21},
                    .head_radius = 0.23,
                    .eyes = {0, 0.7, -0.43},
                    .eye_half = 0.13,
                    .face_depth = 0.26,
                    .neck = {0, 0.48, -0.1},
                    .neck_x = 0.22,
                    .neck_z = 0.18,
                    .back = {0, 0.6, 0.14},
                    .body_radius = 0.31,
                    .body_depth = 0.46};
    return model;
}

Model make_lion(Random& random) {
    const double mane = random.uniform(0.095, 0.115);
    const double girth = random.uniform(0.93, 1.07);
    const double tail_side = random.uniform() < 0.5 ? -1 : 1;
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.28, 0.1}, {0.23 * girth, 0.3, 0.24}, Main));
    s.push_back(ellipsoid({0, 0.33, -0.05}, {0.12, 0.19, 0.12}, Pale));
    s.push_back(ellipsoid({0, 0.7, -0.07}, {0.215, 0.2, 0.19}, Main));
    s.push_back(ellipsoid({0, 0.69, 0.05}, {0.28, 0.27, 0.18}, Deep));
    constexpr int Locks = 11;
    for (int i = 0; i < Locks; ++i) {
        const double angle = 2 * std::numbers::pi * i / Locks;
        const Vec3 out{std::sin(angle), std::cos(angle), 0};
        s.push_back(
            animal_oval(Vec3{0, 0.69, -0.01} + out * 0.245, {0.088, mane, 0.1}, rotation_z(-angle), Deep));
    }
    s.push_back(animal_mark({0, 0.695, -0.325}, {0.055, 0.038, 0.035}));
    s.push_back(ellipsoid({0, 0.71, -0.245}, {0.055, 0.075, 0.075}, Main));
    s.push_back(ellipsoid({0, 0.57, -0.2}, {0.065, 0.05, 0.06}, Pale));
    add_eyes(s, {0, 0.775, -0.22}, 0.1, 0.048);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.19, 0.9, -0.09}, {0.075, 0.075, 0.045}, Main));
        s.push_back(ellipsoid({side * 0.187, 0.9, -0.12}, {0.045, 0.045, 0.03}, Pale));
        s.push_back(ellipsoid({side * 0.065, 0.635, -0.245}, {0.085, 0.062, 0.075}, Pale));
        s.push_back(capsule({side * 0.12, 0.4, -0.1}, {side * 0.125, 0.08, -0.18}, 0.08, 0.07, Main));
        s.push_back(ellipsoid({side * 0.125, 0.05, -0.23}, {0.085, 0.055, 0.1}, Pale));
        s.push_back(ellipsoid({side * 0.21 * girth, 0.14, 0.06}, {0.11, 0.15, 0.19}, Main));
    }
    const AnimalJoint tail[] = {{{0, 0.1, 0.28}, 0.04},
                                {{tail_side * 0.2, 0.09, 0.4}, 0.037},
                                {{tail_side * 0.36, 0.18, 0.34}, 0.035},
                                {{tail_side * 0.41, 0.32, 0.3}, 0.03}};
    animal_limb(s, tail, Main);
    s.push_back(ellipsoid({tail_side * 0.42, 0.39, 0.3}, {0.075, 0.1, 0.075}, Deep));
    model.anchor = {.top = {0, 1.0, -0.03},
                    .head_radius = 0.24,
                    .eyes = {0, 0.775, -0.26},
                    .eye_half = 0.115,
                    .face_depth = 0.2,
                    .neck = {0, 0.43, 0.0},
                    .neck_x = 0.22,
                    .neck_z = 0.18,
                    .back = {0, 0.46, 0.26},
                    .body_radius = 0.36,
                    .body_depth = 0.33};
    return model;
}

Model make_penguin(Random& random) {
    const double girth = random.uniform(0.93, 1.08);
    const double flipper = random.uniform(0.25, 0.6);
    const double beak = random.uniform(0.15, 0.2);
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.38, 0.03}, {0.27 * girth, 0.36, 0.24 * girth}, Main));
    s.push_back(ellipsoid({0, 0.35, 0.03 - 0.1 * girth}, {0.215 * girth, 0.29, 0.18 * girth}, Pale));
    s.push_back(ellipsoid({0, 0.78, 0.0}, {0.23, 0.21, 0.21}, Main));
    s.push_back(ellipsoid({0, 0.71, -0.08}, {0.16, 0.1, 0.135}, Pale));
    add_eyes(s, {0, 0.82, -0.195}, 0.095, 0.05);
    s.push_back(animal_point({0, 0.76, -0.17}, {0, 0.735, -0.21 - beak}, 0.085, {1, 1, 0.6}, AnimalOrange));
    s.back().density = 2;
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.085, 0.8, -0.11}, {0.1, 0.115, 0.095}, Pale));
        const Vec3 shoulder{side * 0.23 * girth, 0.57, 0.02};
        const Vec3 down{side * std::sin(flipper), -std::cos(flipper), 0};
        s.push_back(
            animal_oval(shoulder + down * 0.17, {0.045, 0.22, 0.11}, rotation_z(side * flipper), Main));
        s.push_back(ellipsoid({side * 0.125, 0.035, -0.18}, {0.095, 0.04, 0.12}, AnimalOrange));
        for (const double toe : {-0.065, 0.0, 0.065})
            s.push_back(capsule({side * 0.125, 0.035, -0.2}, {side * 0.125 + toe, 0.025, -0.3}, 0.035, 0.03,
                                AnimalOrange));
    }
    s.push_back(animal_point({0, 0.14, 0.2}, {0, 0.03, 0.4}, 0.11, {1, 1, 0.5}, Main));
    model.anchor = {.top = {0, 0.985, 0.0},
                    .head_radius = 0.22,
                    .eyes = {0, 0.82, -0.235},
                    .eye_half = 0.115,
                    .face_depth = 0.24,
                    .neck = {0, 0.61, 0.01},
                    .neck_x = 0.18,
                    .neck_z = 0.17,
                    .back = {0, 0.5, 0.24},
                    .body_radius = 0.34,
                    .body_depth = 0.32};
    return model;
}

Model make_owl(Random& random) {
    const double girth = random.uniform(0.94, 1.08);
    const double tuft = random.uniform(0.15, 0.2);
    const double wing = random.uniform(0.08, 0.25);
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.36, 0.03}, {0.28 * girth, 0.34, 0.24}, Main));
    Shape belly = ellipsoid({0, 0.32, -0.08}, {0.2 * girth, 0.25, 0.17}, Pale);
    belly.paint_at = [](const SurfacePoint& point) {
        const double row = std::floor(point.position.y / 0.085);
        const double x = point.position.x / 0.1 + (std::fmod(row, 2.0) == 0 ? 0 : 0.5);
        const double arc = std::abs(x - std::round(x)) + (point.position.y / 0.085 - row);
        return arc > 0.45 && arc < 0.85 ? Deep : Pale;
    };
    belly.density = 2;
    s.push_back(belly);
    s.push_back(ellipsoid({0, 0.71, 0.0}, {0.29, 0.225, 0.22}, Main));
    add_eyes(s, {0, 0.73, -0.215}, 0.128, 0.092);
    s.push_back(animal_point({0, 0.675, -0.215}, {0, 0.565, -0.3}, 0.06, {1, 1, 1}, AnimalOrange));
    s.back().density = 2;
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.13, 0.725, -0.13}, {0.155, 0.155, 0.1}, Pale));
        s.push_back(animal_point({side * 0.19, 0.84, -0.04}, {side * 0.29, 0.86 + tuft, -0.07}, 0.105,
                                 {1, 1, 0.7}, Deep));
        s.push_back(animal_oval({side * 0.28 * girth, 0.36, 0.04}, {0.065, 0.26, 0.17},
                                rotation_z(side * wing) * rotation_x(-0.12), Deep));
        for (const double toe : {-0.06, 0.0, 0.06})
            s.push_back(capsule({side * 0.11, 0.035, -0.12}, {side * 0.11 + toe, 0.03, -0.24}, 0.035, 0.03,
                                AnimalOrange));
    }
    s.push_back(animal_oval({0, 0.12, 0.26}, {0.13, 0.03, 0.17}, rotation_x(0.5), Deep));
    model.anchor = {.top = {0, 0.925, -0.01},
                    .head_radius = 0.24,
                    .eyes = {0, 0.73, -0.29},
                    .eye_half = 0.15,
                    .face_depth = 0.29,
                    .neck = {0, 0.53, 0.01},
                    .neck_x = 0.24,
                    .neck_z = 0.2,
                    .back = {0, 0.54, 0.22},
                    .body_radius = 0.35,
                    .body_depth = 0.3};
    return model;
}

Model make_frog(Random& random) {
    const double wide = random.uniform(0.95, 1.08);
    const double eye = random.uniform(0.105, 0.125);
    const double rise = random.uniform(0.0, 0.04);
    const double head = 0.46 + rise;
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.26, 0.08}, {0.27 * wide, 0.26, 0.28}, Main));
    s.push_back(ellipsoid({0, 0.25, -0.07}, {0.2 * wide, 0.2, 0.19}, Pale));
    const Vec3 centre{0, head, -0.1};
    const Vec3 radii{0.33 * wide, 0.19, 0.25};
    s.push_back(ellipsoid(centre, radii, Main));
    s.push_back(ellipsoid({0, head - 0.085, -0.095}, {0.3 * wide, 0.135, 0.235}, Pale));
    animal_smile(s, centre, radii, 0.06, 1.25, 0.02);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.18, head + 0.18, -0.1}, {eye * 1.1, eye * 1.1, eye}, Main));
        s.push_back(animal_mark({side * 0.04, head + 0.055, -0.335}, {0.014, 0.012, 0.012}));
        s.push_back(animal_oval({side * 0.31, 0.18, 0.1}, {0.11, 0.13, 0.24}, rotation_x(-0.5), Main));
        s.push_back(capsule({side * 0.33, 0.06, 0.22}, {side * 0.42, 0.05, -0.06}, 0.055, 0.05, Main));
        s.push_back(capsule({side * 0.16, 0.3, -0.2}, {side * 0.19, 0.06, -0.28}, 0.07, 0.055, Main));
        for (const double toe : {-0.07, 0.0, 0.07}) {
            s.push_back(
                capsule({side * 0.42, 0.04, -0.06}, {side * 0.43 + toe, 0.03, -0.2}, 0.035, 0.035, Main));
            s.push_back(
                capsule({side * 0.19, 0.04, -0.28}, {side * 0.19 + toe, 0.03, -0.37}, 0.035, 0.033, Main));
        }
    }
    add_eyes(s, {0, head + 0.195, -0.17}, 0.18, eye * 0.72);
    model.anchor = {.top = {0, head + 0.22 + eye, -0.03},
                    .head_radius = 0.24,
                    .eyes = {0, head + 0.19, -0.235},
                    .eye_half = 0.17,
                    .face_depth = 0.2,
                    .neck = {0, 0.31 + rise, -0.03},
                    .neck_x = 0.25,
                    .neck_z = 0.22,
                    .back = {0, 0.45, 0.24},
                    .body_radius = 0.42,
                    .body_depth = 0.36};
    return model;
}

Model make_turtle(Random& random) {
    const double dome = random.uniform(0.36, 0.42);
    const double wide = random.uniform(0.95, 1.05);
    const double neck = random.uniform(0.0, 0.06);
    const double head = 0.57 + neck;
    Model model;
    auto& s = model.shapes;
    const Vec3 middle{0, 0.2, 0.12};
    const Vec3 shell{0.36 * wide, dome, 0.39};
    s.push_back(ellipsoid(middle, shell, Deep));
    s.push_back(ellipsoid({0, 0.17, 0.12}, {0.34 * wide, 0.1, 0.37}, Pale));
    s.push_back(torus(middle, 1, 0.12, Main));
    s.back().scale = {0.36 * wide, 0.38, 0.39};
    constexpr int Plates = 7;
    for (int i = 0; i < Plates; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / (Plates - 1);
        const double tilt = i + 1 == Plates ? 0 : 0.93;
        const Vec3 unit{std::sin(tilt) * std::sin(angle), std::cos(tilt), std::sin(tilt) * std::cos(angle)};
        const Vec3 at{unit.x * shell.x, unit.y * shell.y, unit.z * shell.z};
        const Vec3 outward = normalized({unit.x / shell.x, unit.y / shell.y, unit.z / shell.z});
        s.push_back(animal_oval(middle + at, {0.125, 0.03, 0.125}, rotation_to(outward), Pale));
    }
    s.push_back(capsule({0, 0.24, -0.15}, {0, head - 0.05, -0.38}, 0.12, 0.1, Main));
    s.push_back(ellipsoid({0, head, -0.43}, {0.19, 0.165, 0.185}, Main));
    animal_smile(s, {0, head, -0.43}, {0.19, 0.165, 0.185}, 0.085, 0.85, 0.012);
    add_eyes(s, {0, head + 0.045, -0.575}, 0.1, 0.055);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(capsule({side * 0.22, 0.2, -0.12}, {side * 0.35, 0.075, -0.25}, 0.1, 0.085, Main));
        s.push_back(
            animal_oval({side * 0.38, 0.05, -0.29}, {0.1, 0.05, 0.13}, rotation_y(side * -0.5), Main));
        s.push_back(capsule({side * 0.22, 0.2, 0.34}, {side * 0.33, 0.07, 0.46}, 0.095, 0.08, Main));
    }
    s.push_back(animal_point({0, 0.15, 0.46}, {0, 0.1, 0.64}, 0.06, {1, 1, 1}, Main));
    model.anchor = {.top = {0, head + 0.185, -0.36},
                    .head_radius = 0.18,
                    .eyes = {0, head + 0.045, -0.62},
                    .eye_half = 0.115,
                    .face_depth = 0.22,
                    .neck = {0, 0.38 + 0.5 * neck, -0.29},
                    .neck_x = 0.11,
                    .neck_z = 0.12,
                    .back = {0, 0.2 + dome * 0.95, 0.14},
                    .body_radius = 0.4,
                    .body_depth = 0.5};
    return model;
}

namespace {

/// Tyrannosaur's head with open jaws around `at`.
void animal_jaws(ShapeList& shapes, const Vec3& at, double gape) {
    shapes.push_back(ellipsoid(at, {0.2, 0.17, 0.19}, Main));
    shapes.push_back(animal_oval(at + Vec3{0, -0.025, -0.2}, {0.155, 0.095, 0.19}, rotation_x(-0.08), Main));
    shapes.push_back(
        animal_oval(at + Vec3{0, -0.15 - 0.1 * gape, -0.15}, {0.135, 0.05, 0.19}, rotation_x(-gape), Pale));
    shapes.push_back(ellipsoid(at + Vec3{0, -0.1, -0.13}, {0.115, 0.06, 0.17}, AnimalMouth));
    add_eyes(shapes, at + Vec3{0, 0.085, -0.155}, 0.115, 0.054);
    for (const double side : {-1.0, 1.0}) {
        shapes.push_back(animal_mark(at + Vec3{side * 0.05, 0.025, -0.365}, {0.018, 0.015, 0.015}));
        for (const double t : {0.0, 0.5, 1.0}) {
            const Vec3 root = at + Vec3{side * (0.05 + 0.075 * t), -0.085, -0.345 + 0.14 * t * t};
            shapes.push_back(cone(root, root + Vec3{0, -0.06, 0}, 0.024, 0.004, AnimalWhite));
            shapes.back().density = 3;
        }
    }
}

}  // namespace

Model make_dinosaur(Random& random) {
    const double gape = random.uniform(0.25, 0.5);
    const double girth = random.uniform(0.93, 1.08);
    const double swing = random.uniform(-0.16, 0.16);
    Model model;
    auto& s = model.shapes;
    s.push_back(capsule({0, 0.32, 0.1}, {0, 0.55, -0.02}, 0.215 * girth, 0.16, Main));
    s.push_back(ellipsoid({0, 0.39, -0.06}, {0.15 * girth, 0.22, 0.135}, Pale));
    s.push_back(capsule({0, 0.55, 0.0}, {0, 0.78, -0.04}, 0.15, 0.14, Main));
    const Vec3 head{0, 0.83, -0.09};
    animal_jaws(s, head, gape);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.19, 0.23, 0.08}, {0.105, 0.16, 0.14}, Main));
        s.push_back(capsule({side * 0.2, 0.16, 0.08}, {side * 0.2, 0.07, 0.02}, 0.085, 0.075, Main));
        s.push_back(ellipsoid({side * 0.2, 0.05, -0.06}, {0.1, 0.05, 0.14}, Main));
        for (const double toe : {-0.045, 0.045})
            s.push_back(animal_mark({side * 0.2 + toe, 0.03, -0.19}, {0.03, 0.03, 0.04}, AnimalWhite));
        const AnimalJoint arm[] = {{{side * 0.14, 0.52, -0.1}, 0.05},
                                   {{side * 0.19, 0.43, -0.17}, 0.042},
                                   {{side * 0.17, 0.45, -0.27}, 0.036}};
        animal_limb(s, arm, Main);
    }
    const AnimalJoint tail[] = {{{0, 0.3, 0.16}, 0.18},
                                {{swing * 0.2, 0.2, 0.36}, 0.12},
                                {{swing * 0.6, 0.14, 0.52}, 0.075},
                                {{swing, 0.18, 0.66}, 0.03}};
    animal_limb(s, tail, Main);
    const AnimalJoint spikes[] = {{{0, 0.95, 0.03}, 0.6},           {{0, 0.81, 0.1}, 0.5},
                                  {{0, 0.66, 0.13}, 0.3},           {{0, 0.5, 0.25}, 0.5},
                                  {{swing * 0.1, 0.36, 0.34}, 0.8}, {{swing * 0.4, 0.24, 0.47}, 1.0}};
    for (const auto& [at, up] : spikes) {
        const Vec3 out = normalized(Vec3{0, up, 1 - 0.6 * up});
        s.push_back(animal_point(at - out * 0.04, at + out * 0.13, 0.085, {0.45, 1, 1}, Deep));
    }
    model.anchor = {.top = head + Vec3{0, 0.165, -0.02},
                    .head_radius = 0.19,
                    .eyes = head + Vec3{0, 0.085, -0.2},
                    .eye_half = 0.13,
                    .face_depth = 0.22,
                    .neck = {0, 0.62, -0.01},
                    .neck_x = 0.155,
                    .neck_z = 0.155,
                    .back = {0, 0.52, 0.15},
                    .body_radius = 0.33,
                    .body_depth = 0.42};
    return model;
}

}  // namespace gse::synth
