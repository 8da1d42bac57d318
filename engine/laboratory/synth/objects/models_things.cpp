// Things without a face: ball, vase, mushroom, chair, car, house, tree.
#include <array>
#include <cmath>

#include "engine/base/check.h"
#include "engine/laboratory/synth/objects/materials.h"
#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr Paint Tyre{Slot::Fixed, {0.06, 0.06, 0.07}};
constexpr Paint Glass{Slot::Fixed, {0.16, 0.25, 0.36}};
constexpr Paint Bark{Slot::Trim, {0.42, 0.25, 0.11}};

Shape dense(Shape shape, double density) {
    shape.density = density;
    return shape;
}

}  // namespace

Model make_ball(Random& random) {
    const double r = random.uniform(0.44, 0.49);
    const double tilt = random.uniform(0.25, 0.6);
    Model model;
    Shape ball = ellipsoid({0, r, 0}, {r, r, r}, Main);
    ball.rotation = rotation_z(tilt);
    ball.paint_at = [](const SurfacePoint& point) {
        return std::abs(point.v - 0.5) < 0.055 ? Paint{Slot::Pale} : Paint{Slot::Main};
    };
    model.shapes.push_back(ball);
    model.anchor = {.top = {0, 2 * r - 0.01, 0},
                    .head_radius = 0.26,
                    .eyes = {0, 1.25 * r, -0.97 * r},
                    .eye_half = 0.145,
                    .face_depth = 0.34,
                    .neck = {0, 0.58 * r, 0},
                    .neck_x = 0.9 * r,
                    .neck_z = 0.9 * r,
                    .back = {0, 1.1 * r, r * 0.95},
                    .body_radius = r,
                    .body_depth = r};
    return model;
}

Model make_vase(Random& random) {
    const double belly = random.uniform(0.29, 0.35);
    const double belly_at = random.uniform(0.36, 0.46);
    const double neck = random.uniform(0.12, 0.15);
    const double lip = random.uniform(0.19, 0.24);
    const bool handles = random.uniform() < 0.5;
    Model model;
    std::vector<ProfilePoint> profile{{0, 0}, {0.17, 0.0}, {0.19, 0.03}};
    const auto blend = [&](double r0, double y0, double r1, double y1) {
        constexpr int Steps = 6;
        for (int i = 1; i <= Steps; ++i) {
            const double t = static_cast<double>(i) / Steps;
            const double smooth = t * t * (3 - 2 * t);
            profile.push_back({r0 + (r1 - r0) * smooth, y0 + (y1 - y0) * t});
        }
    };
    blend(0.19, 0.03, belly, belly_at);
    blend(belly, belly_at, neck, 0.76);
    blend(neck, 0.76, lip, 0.93);
    for (const ProfilePoint p : {ProfilePoint{lip, 0.96}, {lip - 0.035, 0.96}, {neck - 0.03, 0.76}, {0, 0.7}})
        profile.push_back(p);
    Shape body = revolution({0, 0, 0}, profile, Main);
    body.paint_at = [belly_at](const SurfacePoint& point) {
        const double y = point.position.y;
        if (point.v > 0.89) return Deep;  // inside of the mouth
        return std::abs(y - belly_at) < 0.05 || std::abs(y - 0.8) < 0.025 ? Pale : Main;
    };
    model.shapes.push_back(body);
    if (handles)
        for (const double side : {-1.0, 1.0}) {
            Shape handle = torus({side * (neck + 0.1), 0.69, 0}, 0.11, 0.03, Main);
            handle.rotation = rotation_x(1.5707963);
            model.shapes.push_back(handle);
        }
    model.anchor = {.top = {0, 0.97, 0},
                    .head_radius = 0.21,
                    .eyes = {0, 0.6, -(neck + belly) * 0.52},
                    .eye_half = 0.12,
                    .face_depth = 0.26,
                    .neck = {0, 0.745, 0},
                    .neck_x = neck + 0.01,
                    .neck_z = neck + 0.01,
                    .back = {0, 0.55, belly * 0.8},
                    .body_radius = belly,
                    .body_depth = belly};
    return model;
}

Model make_mushroom(Random& random) {
    const double cap = random.uniform(0.4, 0.46);
    const double stem = random.uniform(0.13, 0.17);
    const double turn = random.uniform(0, 1);
    const Paint cream{Slot::Trim, {0.95, 0.89, 0.74}};
    Model model;
    auto& s = model.shapes;
    s.push_back(revolution(
        {0, 0, 0},
        {{0, 0}, {stem * 1.35, 0.0}, {stem * 1.3, 0.08}, {stem, 0.25}, {stem * 0.95, 0.5}, {0, 0.52}},
        cream));
    std::vector<ProfilePoint> profile{{0, 0.5}, {cap * 0.6, 0.46}, {cap * 0.97, 0.47}};
    for (int i = 0; i <= 8; ++i) {
        const double angle = 1.5707963 * i / 8;
        profile.push_back({cap * std::cos(angle), 0.5 + 0.44 * std::sin(angle)});
    }
    Shape top = revolution({0, 0, 0}, profile, Main);
    top.paint_at = [cream](const SurfacePoint& point) { return point.v < 0.19 ? cream : Main; };
    s.push_back(top);
    const Paint dot{Slot::Trim, {0.98, 0.97, 0.93}};
    for (int i = 0; i < 11; ++i) {
        const double ring = i < 6 ? 0.42 : i < 10 ? 0.98 : 1.57;
        const double angle = 6.2831853 * (turn + (i < 6 ? i / 6.0 : (i + 0.5) / 4.0));
        const Vec3 direction{std::cos(ring) * std::cos(angle), std::sin(ring),
                             std::cos(ring) * std::sin(angle)};
        Shape spot = ellipsoid({direction.x * cap, 0.5 + direction.y * 0.44, direction.z * cap},
                               {0.085, 0.02, 0.085}, dot);
        spot.rotation = rotation_to(normalized({direction.x / cap, direction.y / 0.44, direction.z / cap}));
        s.push_back(dense(spot, 1.5));
    }
    model.anchor = {.top = {0, 0.945, 0},
                    .head_radius = 0.24,
                    .eyes = {0, 0.68, -cap * 0.93},
                    .eye_half = 0.135,
                    .face_depth = 0.3,
                    .neck = {0, 0.31, 0},
                    .neck_x = stem + 0.01,
                    .neck_z = stem + 0.01,
                    .back = {0, 0.6, cap * 0.9},
                    .body_radius = cap,
                    .body_depth = cap};
    return model;
}

Model make_chair(Random& random) {
    const double w = random.uniform(0.24, 0.28);
    const double seat = random.uniform(0.42, 0.47);
    const bool slats = random.uniform() < 0.5;
    Model model;
    auto& s = model.shapes;
    constexpr double Leg = 0.038;
    s.push_back(box({0, seat, 0}, {w + 0.02, 0.04, w + 0.02}, Main));
    for (const double x : {-w + Leg, w - Leg}) {
        s.push_back(box({x, seat * 0.5, -w + Leg}, {Leg, seat * 0.5, Leg}, Deep));
        s.push_back(box({x, seat * 0.5, w - Leg}, {Leg, seat * 0.5, Leg}, Deep));
    }
    if (slats) {
        for (const double x : {-w + Leg, w - Leg})
            s.push_back(box({x, 0.72, w - Leg}, {Leg, 0.28, Leg}, Main));
        for (const double y : {0.62, 0.76}) s.push_back(box({0, y, w - Leg}, {w - Leg, 0.045, 0.025}, Main));
        s.push_back(box({0, 0.93, w - Leg}, {w, 0.07, 0.04}, Main));
    } else {
        s.push_back(box({0, 0.74, w - Leg}, {w, 0.26, 0.035}, Main));
    }
    model.anchor = {.top = {0, 1.03, w - Leg},
                    .head_radius = 0.22,
                    .eyes = {0, 0.82, w - 2 * Leg - 0.01},
                    .eye_half = 0.125,
                    .face_depth = 0.12,
                    .neck = {0, 0.66, w - Leg},
                    .neck_x = w + 0.01,
                    .neck_z = 0.06,
                    .back = {0, 0.72, w},
                    .body_radius = w + 0.03,
                    .body_depth = w + 0.03};
    return model;
}

Model make_car(Random& random) {
    const double half = random.uniform(0.5, 0.56);
    const double roof = random.uniform(0.62, 0.7);
    const double w = 0.27;
    const bool hatch = random.uniform() < 0.5;
    const double cabin_front = -0.17;
    const double cabin_back = hatch ? half - 0.04 : 0.3;
    Model model;
    auto& s = model.shapes;
    s.push_back(box({0, 0.27, 0}, {w, 0.12, half}, Main));
    s.push_back(ellipsoid({0, 0.3, -half + 0.05}, {w, 0.13, 0.12}, Main));
    const double middle = 0.5 * (cabin_front + cabin_back);
    const double length_half = 0.5 * (cabin_back - cabin_front);
    // Cabin: a block of glass with a roof and pillars.
    s.push_back(box({0, 0.48, middle}, {w - 0.035, 0.13, length_half - 0.02}, Glass));
    s.push_back(box({0, roof - 0.03, middle}, {w - 0.02, 0.04, length_half}, Main));
    for (const double side : {-1.0, 1.0}) {
        for (const double z : {cabin_front + 0.025, middle, cabin_back - 0.025})
            s.push_back(box({side * (w - 0.04), 0.5, z}, {0.022, 0.13, 0.03}, Main));
        for (const double z : {-half + 0.2, half - 0.2}) {
            s.push_back(
                cone({side * (w - 0.08), 0.13, z}, {side * (w + 0.035), 0.13, z}, 0.135, 0.135, Tyre));
            Shape hub = cone({side * (w + 0.02), 0.13, z}, {side * (w + 0.05), 0.13, z}, 0.07, 0.06,
                             {Slot::Fixed, {0.75, 0.76, 0.78}});
            s.push_back(dense(hub, 2));
        }
        Shape lamp = ellipsoid({side * 0.17, 0.31, -half - 0.055}, {0.065, 0.06, 0.04},
                               {Slot::Fixed, {1.0, 0.96, 0.72}});
        s.push_back(dense(lamp, 2.5));
        s.push_back(
            dense(box({side * 0.19, 0.31, half}, {0.05, 0.04, 0.015}, {Slot::Fixed, {0.75, 0.03, 0.03}}), 2));
    }
    s.push_back(box({0, 0.19, -half - 0.05}, {w + 0.01, 0.035, 0.035}, {Slot::Fixed, {0.6, 0.61, 0.63}}));
    s.push_back(box({0, 0.19, half + 0.02}, {w + 0.01, 0.035, 0.03}, {Slot::Fixed, {0.6, 0.61, 0.63}}));
    model.anchor = {.top = {0, roof + 0.055, middle},
                    .head_radius = 0.24,
                    .eyes = {0, 0.5, cabin_front - 0.02},
                    .eye_half = 0.13,
                    .face_depth = 0.2,
                    .neck = {0, 0.44, middle},
                    .neck_x = w + 0.005,
                    .neck_z = length_half + 0.01,
                    .back = {0, 0.5, middle + 0.1},
                    .body_radius = w + 0.05,
                    .body_depth = half};
    return model;
}

Model make_house(Random& random) {
    const double w = random.uniform(0.34, 0.4);
    const double d = random.uniform(0.3, 0.36);
    const double wall = random.uniform(0.48, 0.55);
    const double ridge = 0.92;
    const double chimney_side = random.uniform() < 0.5 ? -1 : 1;
    const Paint door{Slot::Fixed, {0.33, 0.18, 0.08}};
    const Paint window{Slot::Fixed, {1.0, 0.95, 0.6}};
    Model model;
    auto& s = model.shapes;
    s.push_back(box({0, wall * 0.5, 0}, {w, wall * 0.5, d}, Main));
    // The ridge runs along z, so that the front shows the gable.
    for (const double z : {-d, d})
        s.push_back(sheet(
            {0, wall, 0},
            [=](double u, double v) {
                return Vec3{(2 * u - 1) * w * (1 - v), wall + (ridge - wall) * v, z};
            },
            Main));
    const double slope = std::atan2(ridge - wall, w);
    const double run = std::hypot(ridge - wall, w) * 0.5 + 0.05;
    for (const double side : {-1.0, 1.0}) {
        Shape roof =
            box({side * (w * 0.5 + 0.012), 0.5 * (wall + ridge) + 0.012, 0}, {run, 0.03, d + 0.06}, Deep);
        roof.rotation = rotation_z(-side * slope);
        s.push_back(roof);
        const double z = -d - 0.008;
        s.push_back(dense(box({side * w * 0.6, wall * 0.62, z}, {0.075, 0.08, 0.012}, window), 2));
        for (const double along : {-0.45, 0.45})
            s.push_back(
                dense(box({side * (w + 0.005), wall * 0.6, along * d}, {0.012, 0.08, 0.075}, window), 2));
    }
    s.push_back(dense(box({0, 0.16, -d - 0.012}, {0.085, 0.16, 0.015}, door), 2));
    s.push_back(dense(box({0, wall * 0.62, d + 0.005}, {0.1, 0.08, 0.012}, window), 2));
    s.push_back(box({chimney_side * w * 0.55, 0.86, 0.12}, {0.055, 0.15, 0.055}, Main));
    model.anchor = {.top = {0, ridge + 0.075, -0.02},
                    .head_radius = 0.25,
                    .eyes = {0, wall * 0.9, -d - 0.03},
                    .eye_half = 0.15,
                    .face_depth = 0.3,
                    .neck = {0, wall * 0.78, 0},
                    .neck_x = w + 0.0,
                    .neck_z = d + 0.0,
                    .back = {0, wall * 0.95, d + 0.05},
                    .body_radius = w + 0.05,
                    .body_depth = d + 0.05};
    return model;
}

Model make_tree(Random& random) {
    const double trunk = random.uniform(0.32, 0.4);
    const double wide = random.uniform(0.25, 0.29);
    const double turn = random.uniform(0, 6.2831853);
    const Vec3 offset{random.uniform(0, 40), 0, random.uniform(0, 40)};
    const auto leaves = [offset](const SurfacePoint& point) {
        const double dapple = value_noise((point.position + offset) * 9.0);
        return dapple < 0.38 ? Deep : Main;
    };
    Model model;
    auto& s = model.shapes;
    s.push_back(cone({0, 0, 0}, {0, trunk + 0.15, 0}, 0.11, 0.075, Bark));
    s.push_back(capsule({0.03, trunk - 0.1, 0}, {0.2, trunk + 0.12, -0.05}, 0.045, 0.04, Bark));
    const auto add_leaves = [&](const Vec3& centre, double radius) {
        s.push_back(ellipsoid(centre, {radius, radius * 0.88, radius}));
        s.back().paint_at = leaves;
    };
    constexpr int Around = 5;
    const double low = trunk + 0.2;
    for (int i = 0; i < Around; ++i) {
        const double angle = turn + 6.2831853 * i / Around;
        const double lift = i % 2 == 0 ? 0.0 : 0.07;
        add_leaves({wide * 0.88 * std::cos(angle), low + lift, wide * 0.88 * std::sin(angle)}, 0.2);
    }
    add_leaves({0, low + 0.15, 0}, 0.27);
    add_leaves({0.02, 0.88, -0.02}, 0.185);
    model.anchor = {.top = {0, 1.04, 0},
                    .head_radius = 0.2,
                    .eyes = {0, low + 0.12, -wide * 0.88 - 0.15},
                    .eye_half = 0.135,
                    .face_depth = 0.25,
                    .neck = {0, trunk - 0.04, 0},
                    .neck_x = 0.085,
                    .neck_z = 0.085,
                    .back = {0, low + 0.1, wide * 0.88 + 0.1},
                    .body_radius = wide + 0.16,
                    .body_depth = wide + 0.16};
    return model;
}

Model make_object(const std::string& word, Random random) {
    struct Maker {
        const char* word;
        Model (*make)(Random&);
    };
    static constexpr Maker Makers[] = {
        {"bear", make_bear},         {"dog", make_dog},           {"cat", make_cat},
        {"duck", make_duck},         {"statue", make_statue},     {"ball", make_ball},
        {"vase", make_vase},         {"mushroom", make_mushroom}, {"chair", make_chair},
        {"car", make_car},           {"house", make_house},       {"tree", make_tree},
        {"rabbit", make_rabbit},     {"horse", make_horse},       {"elephant", make_elephant},
        {"pig", make_pig},           {"lion", make_lion},         {"penguin", make_penguin},
        {"owl", make_owl},           {"frog", make_frog},         {"turtle", make_turtle},
        {"dinosaur", make_dinosaur}, {"snowman", make_snowman},   {"robot", make_robot},
        {"pumpkin", make_pumpkin},   {"cactus", make_cactus},     {"teapot", make_teapot},
        {"rocket", make_rocket},     {"castle", make_castle},     {"lamp", make_lamp}};
    for (const auto& maker : Makers)
        if (word == maker.word) return maker.make(random);
    GSE_CHECK(false);
    return {};
}

}  // namespace gse::synth
