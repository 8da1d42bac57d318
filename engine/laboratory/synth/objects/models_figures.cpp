// Figures with a face: bear, dog, cat, duck, statue.
#include <cmath>

#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr Paint EyeWhite{Slot::Fixed, {0.97, 0.97, 0.95}};
constexpr Paint Ink{Slot::Fixed, {0.03, 0.03, 0.04}};

Shape nose(const Vec3& centre, double size) {
    Shape shape = ellipsoid(centre, {size, size * 0.8, size * 0.7}, Ink);
    shape.density = 3;
    return shape;
}

}  // namespace

void add_eyes(ShapeList& shapes, const Vec3& middle, double half, double radius) {
    for (const double side : {-1.0, 1.0}) {
        Shape white =
            ellipsoid(middle + Vec3{side * half, 0, 0}, {radius, radius * 1.15, radius * 0.7}, EyeWhite);
        white.density = 3;
        shapes.push_back(white);
        const Vec3 pupil_at = middle + Vec3{side * half * 0.95, -radius * 0.05, -radius * 0.45};
        Shape pupil = ellipsoid(pupil_at, {radius * 0.62, radius * 0.75, radius * 0.4}, Ink);
        pupil.density = 4;
        shapes.push_back(pupil);
    }
}

Model make_bear(Random& random) {
    const double girth = random.uniform(0.9, 1.12);
    const double arm = random.uniform(-0.06, 0.14);
    const double other_arm = random.uniform(-0.06, 0.14);
    const double ear = random.uniform(0.105, 0.125);
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.32, 0.02}, {0.27 * girth, 0.31, 0.23 * girth}, Main));
    s.push_back(ellipsoid({0, 0.31, -0.09 * girth}, {0.19 * girth, 0.21, 0.15 * girth}, Pale));
    s.push_back(ellipsoid({0, 0.73, -0.02}, {0.29, 0.25, 0.24}, Main));
    s.push_back(ellipsoid({0, 0.65, -0.2}, {0.14, 0.105, 0.12}, Pale));
    s.push_back(nose({0, 0.695, -0.305}, 0.06));
    add_eyes(s, {0, 0.79, -0.21}, 0.11, 0.056);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.25, 0.93, 0.0}, {ear, ear, 0.06}, Main));
        s.push_back(ellipsoid({side * 0.25, 0.925, -0.035}, {ear * 0.6, ear * 0.6, 0.045}, Pale));
        const double lift = side < 0 ? arm : other_arm;
        s.push_back(capsule({side * 0.22 * girth, 0.48, -0.02}, {side * 0.37, 0.30 + lift, -0.16}, 0.085,
                            0.095, Main));
        s.push_back(capsule({side * 0.15, 0.11, -0.08}, {side * 0.24, 0.12, -0.34}, 0.11, 0.105, Main));
        s.push_back(ellipsoid({side * 0.245, 0.125, -0.41}, {0.075, 0.08, 0.055}, Pale));
    }
    s.push_back(ellipsoid({0, 0.15, 0.26 * girth}, {0.07, 0.07, 0.06}, Main));
    model.anchor = {.top = {0, 0.98, 0.0},
                    .head_radius = 0.25,
                    .eyes = {0, 0.79, -0.255},
                    .eye_half = 0.125,
                    .face_depth = 0.27,
                    .neck = {0, 0.53, -0.01},
                    .neck_x = 0.2,
                    .neck_z = 0.18,
                    .back = {0, 0.48, 0.2},
                    .body_radius = 0.38,
                    .body_depth = 0.32};
    return model;
}

Model make_dog(Random& random) {
    const double leg = random.uniform(0.26, 0.34);
    const double body = random.uniform(0.17, 0.2);
    const double rear = random.uniform(0.3, 0.36);
    const double tail = random.uniform(-0.12, 0.12);
    const double spine = leg + body * 0.85;
    const double head = spine + 0.3;
    Model model;
    auto& s = model.shapes;
    s.push_back(capsule({0, spine, -0.16}, {0, spine, rear}, body * 1.05, body * 0.95, Main));
    s.push_back(capsule({0, spine + 0.03, -0.2}, {0, head, -0.3}, 0.15, 0.13, Main));
    s.push_back(ellipsoid({0, head, -0.33}, {0.215, 0.2, 0.2}, Main));
    s.push_back(capsule({0, head - 0.07, -0.46}, {0, head - 0.085, -0.6}, 0.115, 0.1, Pale));
    s.push_back(nose({0, head - 0.035, -0.695}, 0.062));
    add_eyes(s, {0, head + 0.06, -0.49}, 0.09, 0.052);
    for (const double side : {-1.0, 1.0}) {
        Shape ear = ellipsoid({side * 0.225, head - 0.02, -0.3}, {0.05, 0.19, 0.1}, Deep);
        ear.rotation = rotation_z(side * 0.22);
        s.push_back(ear);
        for (const double z : {-0.18, rear - 0.02}) {
            s.push_back(capsule({side * 0.115, spine - 0.03, z}, {side * 0.125, 0.07, z}, 0.085, 0.07, Main));
            s.push_back(ellipsoid({side * 0.125, 0.05, z - 0.035}, {0.08, 0.055, 0.1}, Pale));
        }
    }
    s.push_back(capsule({0, spine + 0.08, rear + 0.1}, {tail, spine + 0.4, rear + 0.26}, 0.06, 0.04, Main));
    model.anchor = {.top = {0, head + 0.205, -0.32},
                    .head_radius = 0.2,
                    .eyes = {0, head + 0.06, -0.535},
                    .eye_half = 0.11,
                    .face_depth = 0.24,
                    .neck = {0, spine + 0.13, -0.24},
                    .neck_x = 0.155,
                    .neck_z = 0.165,
                    .back = {0, spine + 0.16, 0.0},
                    .body_radius = 0.26,
                    .body_depth = 0.55};
    return model;
}

Model make_cat(Random& random) {
    const double girth = random.uniform(0.9, 1.1);
    const double tail_side = random.uniform() < 0.5 ? -1 : 1;
    const double ear = random.uniform(0.2, 0.25);
    Model model;
    auto& s = model.shapes;
    s.push_back(revolution({0, 0, 0.08},
                           {{0, 0},
                            {0.24 * girth, 0.01},
                            {0.27 * girth, 0.1},
                            {0.26 * girth, 0.2},
                            {0.22 * girth, 0.33},
                            {0.17, 0.46},
                            {0.12, 0.56},
                            {0, 0.6}},
                           Main));
    s.push_back(ellipsoid({0, 0.38, -0.07}, {0.1, 0.15, 0.07}, Pale));
    s.push_back(ellipsoid({0, 0.7, -0.03}, {0.26, 0.2, 0.2}, Main));
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.07, 0.625, -0.19}, {0.085, 0.065, 0.06}, Pale));
        Shape outer =
            cone({side * 0.165, 0.81, -0.02}, {side * 0.215, 0.83 + ear, -0.01}, 0.105, 0.008, Main);
        s.push_back(outer);
        Shape inner =
            cone({side * 0.165, 0.82, -0.065}, {side * 0.21, 0.79 + ear, -0.05}, 0.065, 0.005, Pale);
        s.push_back(inner);
        s.push_back(capsule({side * 0.09, 0.36, -0.12}, {side * 0.095, 0.06, -0.2}, 0.07, 0.06, Main));
        s.push_back(ellipsoid({side * 0.095, 0.045, -0.24}, {0.07, 0.05, 0.09}, Pale));
        s.push_back(ellipsoid({side * 0.22 * girth, 0.13, 0.02}, {0.1, 0.14, 0.19}, Main));
    }
    Shape snout = nose({0, 0.655, -0.255}, 0.032);
    snout.paint = {Slot::Fixed, {0.95, 0.45, 0.5}};
    s.push_back(snout);
    add_eyes(s, {0, 0.735, -0.185}, 0.1, 0.056);
    Vec3 from{tail_side * 0.1, 0.07, 0.3};
    constexpr int Pieces = 7;
    for (int i = 1; i <= Pieces; ++i) {
        const double t = static_cast<double>(i) / Pieces;
        const Vec3 to{tail_side * (0.1 + 0.34 * std::sin(1.9 * t)), 0.07 + 0.5 * t * t,
                      0.3 + 0.12 * std::sin(3.1 * t)};
        s.push_back(capsule(from, to, 0.052, 0.052, Main));
        from = to;
    }
    model.anchor = {.top = {0, 0.925, -0.01},
                    .head_radius = 0.21,
                    .eyes = {0, 0.735, -0.23},
                    .eye_half = 0.12,
                    .face_depth = 0.23,
                    .neck = {0, 0.53, 0.03},
                    .neck_x = 0.155,
                    .neck_z = 0.155,
                    .back = {0, 0.4, 0.24},
                    .body_radius = 0.33,
                    .body_depth = 0.32};
    return model;
}

Model make_duck(Random& random) {
    const double fat = random.uniform(0.92, 1.1);
    const double neck = random.uniform(0.0, 0.07);
    const Paint beak{Slot::Trim, {1.0, 0.5, 0.03}};
    Model model;
    auto& s = model.shapes;
    const double head = 0.73 + neck;
    s.push_back(ellipsoid({0, 0.3, 0.06}, {0.29 * fat, 0.27, 0.4}, Main));
    s.push_back(cone({0, 0.36, 0.3}, {0, 0.58, 0.56}, 0.16, 0.02, Main));
    s.push_back(capsule({0, 0.42, -0.17}, {0, head, -0.2}, 0.17, 0.14, Main));
    s.push_back(ellipsoid({0, head, -0.2}, {0.22, 0.21, 0.21}, Main));
    for (const double y : {0.0, -0.055}) {
        Shape half = ellipsoid({0, head - 0.03 + y, -0.43 - 0.3 * y}, {0.125, 0.04, 0.15}, beak);
        half.rotation = rotation_x(y < 0 ? 0.1 : -0.1);
        half.density = 2;
        s.push_back(half);
    }
    add_eyes(s, {0, head + 0.075, -0.365}, 0.1, 0.052);
    for (const double side : {-1.0, 1.0}) {
        Shape wing = ellipsoid({side * 0.28 * fat, 0.34, 0.09}, {0.055, 0.15, 0.26}, Pale);
        wing.rotation = rotation_x(-0.25);
        s.push_back(wing);
        s.push_back(ellipsoid({side * 0.12, 0.03, -0.18}, {0.1, 0.035, 0.15}, beak));
    }
    model.anchor = {.top = {0, head + 0.215, -0.19},
                    .head_radius = 0.2,
                    .eyes = {0, head + 0.07, -0.405},
                    .eye_half = 0.115,
                    .face_depth = 0.24,
                    .neck = {0, head - 0.22, -0.19},
                    .neck_x = 0.165,
                    .neck_z = 0.165,
                    .back = {0, 0.5, 0.12},
                    .body_radius = 0.33,
                    .body_depth = 0.45};
    return model;
}

Model make_statue(Random& random) {
    const double wide = random.uniform(0.92, 1.08);
    const bool beard = random.uniform() < 0.5;
    Model model;
    auto& s = model.shapes;
    s.push_back(box({0, 0.07, 0}, {0.26, 0.07, 0.22}, Main));
    s.push_back(box({0, 0.175, 0}, {0.19, 0.04, 0.16}, Deep));
    s.push_back(cone({0, 0.2, 0}, {0, 0.3, 0}, 0.11, 0.16, Main));
    s.push_back(ellipsoid({0, 0.42, 0.01}, {0.26 * wide, 0.17, 0.17}, Main));
    for (const double side : {-1.0, 1.0}) {
        s.push_back(ellipsoid({side * 0.24 * wide, 0.46, 0.01}, {0.11, 0.12, 0.12}, Main));
        s.push_back(ellipsoid({side * 0.195, 0.79, 0.0}, {0.03, 0.06, 0.045}, Main));
        Shape socket = ellipsoid({side * 0.08, 0.815, -0.175}, {0.05, 0.032, 0.025}, Deep);
        socket.density = 2.5;
        s.push_back(socket);
        Shape brow = capsule({side * 0.03, 0.855, -0.2}, {side * 0.13, 0.86, -0.17}, 0.025, 0.02, Main);
        brow.density = 2;
        s.push_back(brow);
    }
    s.push_back(cone({0, 0.48, 0}, {0, 0.68, 0}, 0.12, 0.1, Main));
    s.push_back(ellipsoid({0, 0.79, 0}, {0.19, 0.22, 0.2}, Main));
    s.push_back(ellipsoid({0, 0.86, 0.035}, {0.205, 0.19, 0.2}, Deep));
    s.push_back(capsule({0, 0.85, -0.195}, {0, 0.765, -0.235}, 0.025, 0.045, Main));
    Shape mouth = ellipsoid({0, 0.69, -0.18}, {0.07, 0.018, 0.03}, Deep);
    mouth.density = 2;
    s.push_back(mouth);
    if (beard) s.push_back(ellipsoid({0, 0.61, -0.12}, {0.12, 0.1, 0.09}, Deep));
    model.anchor = {.top = {0, 1.04, 0.03},
                    .head_radius = 0.2,
                    .eyes = {0, 0.815, -0.215},
                    .eye_half = 0.105,
                    .face_depth = 0.22,
                    .neck = {0, 0.57, 0},
                    .neck_x = 0.125,
                    .neck_z = 0.125,
                    .back = {0, 0.48, 0.16},
                    .body_radius = 0.36,
                    .body_depth = 0.24};
    return model;
}

}  // namespace gse::synth
