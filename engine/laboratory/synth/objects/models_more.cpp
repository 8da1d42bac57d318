// More things: snowman, robot, pumpkin, cactus, teapot, rocket, castle, lamp.
#include <algorithm>
#include <cmath>

#include "engine/laboratory/synth/objects/models.h"

namespace gse::synth {
namespace {

constexpr double Circle = 6.283185307179586;
constexpr Paint Coal{Slot::Fixed, {0.04, 0.04, 0.05}};

Shape finer(Shape shape, double density) {
    shape.density = density;
    return shape;
}

/// Flat round plate whose face looks along the unit vector `facing`.
Shape plate(const Vec3& centre, const Vec3& facing, double radius, double half, Paint paint) {
    return finer(cone(centre - facing * half, centre + facing * half, radius, radius * 0.92, paint), 2);
}

/// Thin swept fin from the axis outwards in direction `angle`, standing on the ground.
Shape rocket_fin(double angle, double reach) {
    const Vec3 out{std::sin(angle), 0, std::cos(angle)};
    const Vec3 across{std::cos(angle), 0, -std::sin(angle)};
    return sheet(
        out * (0.5 * reach) + Vec3{0, 0.22, 0},
        [=](double u, double v) {
            const double r = 0.08 + (reach - 0.08) * v;
            const double high = 0.44 - 0.26 * v * v;
            const double low = 0.17 - 0.17 * v;
            const double c = std::cos(Circle * u);
            return out * r + Vec3{0, 0.5 * (high + low) + 0.5 * (high - low) * c, 0} +
                   across * (0.03 * std::sin(Circle * u));
        },
        Deep);
}

/// True where a jack-o'-lantern's face is cut out; x from the middle, y from the ground.
bool carved(double x, double y) {
    const double side = std::abs(x);
    if (y > 0.43 && y < 0.62 && std::abs(side - 0.165) < 0.115 * (0.63 - y) / 0.19) return true;
    if (y > 0.355 && y < 0.44 && side < 0.055 * (0.45 - y) / 0.09) return true;
    const double low = 0.16 + 1.1 * side * side;
    const double high = 0.305 + 0.4 * side * side;
    if (side > 0.3 || y < low || y > high) return false;
    const bool upper_tooth = std::abs(side - 0.1) < 0.036 && y > high - 0.06;
    const bool lower_tooth = side < 0.04 && y < low + 0.06;
    return !upper_tooth && !lower_tooth;
}

}  // namespace

Model make_snowman(Random& random) {
    const double fat = random.uniform(0.94, 1.08);
    const double arm = random.uniform(-0.08, 0.1);
    const double other_arm = random.uniform(-0.08, 0.1);
    const double carrot = random.uniform(0.21, 0.29);
    const Paint orange{Slot::Trim, {1.0, 0.47, 0.04}};
    const Paint stick{Slot::Trim, {0.36, 0.21, 0.1}};
    Model model;
    auto& s = model.shapes;
    s.push_back(ellipsoid({0, 0.245, 0}, {0.3 * fat, 0.265, 0.29 * fat}, Main));
    s.push_back(ellipsoid({0, 0.57, 0}, {0.225 * fat, 0.2, 0.215 * fat}, Main));
    s.push_back(ellipsoid({0, 0.84, 0}, {0.19, 0.175, 0.185}, Main));
    s.push_back(finer(cone({0, 0.83, -0.15}, {0, 0.815, -0.18 - carrot}, 0.055, 0.006, orange), 2.5));
    for (const double side : {-1.0, 1.0}) {
        s.push_back(finer(ellipsoid({side * 0.075, 0.9, -0.162}, {0.036, 0.038, 0.028}, Coal), 4));
        s.push_back(finer(ellipsoid({side * 0.09, 0.765, -0.15}, {0.02, 0.02, 0.02}, Coal), 4));
        s.push_back(finer(ellipsoid({side * 0.045, 0.738, -0.152}, {0.02, 0.02, 0.02}, Coal), 4));
        const double lift = side < 0 ? arm : other_arm;
        const Vec3 shoulder{side * 0.18 * fat, 0.6, -0.02};
        const Vec3 hand{side * 0.46, 0.74 + lift, -0.08};
        s.push_back(capsule(shoulder, hand, 0.03, 0.022, stick));
        const Vec3 wrist = shoulder + (hand - shoulder) * 0.72;
        s.push_back(capsule(wrist, wrist + Vec3{side * 0.03, 0.11, 0}, 0.02, 0.014, stick));
        s.push_back(capsule(wrist, wrist + Vec3{side * 0.12, -0.035, 0}, 0.02, 0.014, stick));
    }
    for (const double y : {0.66, 0.575, 0.49}) {
        const double up = (y - 0.57) / 0.2;
        const double z = -0.215 * fat * std::sqrt(1 - up * up) - 0.004;
        s.push_back(finer(ellipsoid({0, y, z}, {0.03, 0.03, 0.022}, Coal), 4));
    }
    model.anchor = {.top = {0, 1.005, 0},
                    .head_radius = 0.19,
                    .eyes = {0, 0.895, -0.195},
                    .eye_half = 0.1,
                    .face_depth = 0.2,
                    .neck = {0, 0.715, 0},
                    .neck_x = 0.155,
                    .neck_z = 0.155,
                    .back = {0, 0.6, 0.2},
                    .body_radius = 0.34,
                    .body_depth = 0.3};
    return model;
}

Model make_robot(Random& random) {
    const double w = random.uniform(0.18, 0.215);
    const double head = random.uniform(0.165, 0.195);
    const double arm = random.uniform(-0.02, 0.2);
    const double other_arm = random.uniform(-0.02, 0.2);
    const Paint lit{Slot::Fixed, {0.55, 0.97, 1.0}};
    const Vec3 front{0, 0, -1};
    Model model;
    auto& s = model.shapes;
    s.push_back(box({0, 0.42, 0}, {w, 0.175, 0.145}, Main));
    s.push_back(cone({0, 0.58, 0}, {0, 0.66, 0}, 0.075, 0.075, Deep));
    s.push_back(box({0, 0.77, -0.01}, {head, 0.13, 0.15}, Main));
    s.push_back(capsule({0, 0.89, 0}, {0, 0.99, 0}, 0.02, 0.018, Deep));
    s.push_back(finer(ellipsoid({0, 1.01, 0}, {0.04, 0.04, 0.04}, {Slot::Fixed, {0.92, 0.08, 0.06}}), 2));
    s.push_back(finer(box({0, 0.44, -0.15}, {w * 0.7, 0.1, 0.015}, Pale), 1.5));
    const Vec3 lamps[] = {{0.92, 0.1, 0.08}, {1.0, 0.8, 0.1}, {0.1, 0.8, 0.25}};
    for (int i = 0; i < 3; ++i)
        s.push_back(plate({(i - 1) * w * 0.43, 0.48, -0.167}, front, 0.032, 0.012, {Slot::Fixed, lamps[i]}));
    s.push_back(finer(box({0, 0.395, -0.165}, {w * 0.5, 0.025, 0.01}, Coal), 2));
    Shape grille = finer(box({0, 0.69, -0.16}, {head * 0.6, 0.03, 0.012}, Coal), 3);
    grille.paint_at = [head](const SurfacePoint& point) {
        return std::fmod((point.position.x + head) * 28, 1.0) < 0.35 ? Pale : Coal;
    };
    s.push_back(grille);
    for (const double side : {-1.0, 1.0}) {
        s.push_back(plate({side * 0.08, 0.805, -0.165}, front, 0.064, 0.016, Coal));
        s.push_back(plate({side * 0.08, 0.805, -0.18}, front, 0.045, 0.016, lit));
        s.push_back(cone({side * head, 0.77, 0}, {side * (head + 0.045), 0.77, 0}, 0.06, 0.045, Deep));
        const double lift = side < 0 ? arm : other_arm;
        const Vec3 shoulder{side * (w + 0.055), 0.53, 0};
        const Vec3 hand{side * (w + 0.13), 0.27 + lift, -0.12 - 0.3 * lift};
        s.push_back(ellipsoid(shoulder, {0.075, 0.075, 0.075}, Deep));
        s.push_back(cone(shoulder, hand, 0.05, 0.05, Main));
        s.push_back(ellipsoid(hand, {0.07, 0.07, 0.07}, Deep));
        s.push_back(cone({side * 0.1, 0.28, 0}, {side * 0.1, 0.05, 0}, 0.06, 0.06, Deep));
        s.push_back(box({side * 0.105, 0.045, -0.035}, {0.088, 0.045, 0.13}, Main));
    }
    model.anchor = {.top = {0, 0.91, -0.01},
                    .head_radius = head + 0.02,
                    .eyes = {0, 0.805, -0.2},
                    .eye_half = 0.115,
                    .face_depth = 0.2,
                    .neck = {0, 0.615, 0},
                    .neck_x = 0.13,
                    .neck_z = 0.12,
                    .back = {0, 0.48, 0.145},
                    .body_radius = w + 0.14,
                    .body_depth = 0.24};
    return model;
}

Model make_pumpkin(Random& random) {
    const double wide = random.uniform(0.94, 1.06);
    const double lean = random.uniform(-0.1, 0.1);
    constexpr int Ribs = 10;
    constexpr double High = 0.345;
    const Paint stem{Slot::Trim, {0.25, 0.42, 0.12}};
    const Paint hole{Slot::Fixed, {0.05, 0.025, 0.01}};
    Model model;
    auto& s = model.shapes;
    for (int i = 0; i < Ribs; ++i) {
        const double angle = Circle * i / Ribs;
        const Vec3 out{std::sin(angle), 0, -std::cos(angle)};
        const Vec3 across = cross(out, {0, 1, 0});
        Shape rib = ellipsoid(out * (0.2 * wide) + Vec3{0, High, 0}, {0.24 * wide, High, 0.155 * wide});
        rib.rotation = Mat3::from_columns(out, {0, 1, 0}, across);
        rib.density = out.z < -0.3 ? 3 : 1;
        rib.paint_at = [=](const SurfacePoint& point) {
            const Vec3& p = point.position;
            if (p.z < -0.12 && carved(p.x, p.y)) return hole;
            const double aside = std::atan2(std::abs(dot(p, across)), dot(p, out));
            return aside > 0.8 * 0.5 * Circle / Ribs ? Deep : Main;
        };
        s.push_back(rib);
    }
    s.push_back(cone({0, 0.5, 0}, {0, 0.7, 0}, 0.1, 0.055, stem));
    s.push_back(capsule({0, 0.69, 0}, {lean, 0.8, 0.02}, 0.052, 0.05, stem));
    Shape curl = capsule({0.04, 0.665, -0.05}, {0.18, 0.69, -0.14}, 0.02, 0.012, stem);
    s.push_back(curl);
    model.anchor = {.top = {0, 0.715, 0},
                    .head_radius = 0.25,
                    .eyes = {0, 0.5, -0.42 * wide},
                    .eye_half = 0.155,
                    .face_depth = 0.34,
                    .neck = {0, 0.16, 0},
                    .neck_x = 0.38 * wide,
                    .neck_z = 0.38 * wide,
                    .back = {0, 0.46, 0.41 * wide},
                    .body_radius = 0.44 * wide,
                    .body_depth = 0.44 * wide};
    return model;
}

Model make_cactus(Random& random) {
    const double thick = random.uniform(0.125, 0.15);
    const double left = random.uniform(0.46, 0.54);
    const double right = random.uniform(0.52, 0.62);
    const double flip = random.uniform() < 0.5 ? -1 : 1;
    const Paint clay{Slot::Trim, {0.76, 0.36, 0.19}};
    const Paint blossom{Slot::Trim, {0.98, 0.3, 0.55}};
    const auto ribbed = [](Shape shape, int ribs) {
        shape.paint_at = [ribs](const SurfacePoint& point) {
            const double phase = std::fmod(point.u * ribs, 1.0);
            if (phase > 0.3) return Main;
            return std::fmod(point.position.y * 16, 1.0) < 0.6 ? Pale : Deep;
        };
        return shape;
    };
    Model model;
    auto& s = model.shapes;
    s.push_back(revolution({0, 0, 0}, {{0, 0}, {0.17, 0}, {0.23, 0.2}, {0, 0.21}}, clay));
    Shape rim = revolution(
        {0, 0, 0}, {{0, 0.17}, {0.265, 0.17}, {0.275, 0.26}, {0.23, 0.26}, {0.22, 0.235}, {0, 0.235}}, clay);
    rim.paint_at = [clay](const SurfacePoint& point) {
        return point.v > 0.8 ? Paint{Slot::Fixed, {0.2, 0.12, 0.07}} : clay;
    };
    s.push_back(rim);
    s.push_back(ribbed(capsule({0, 0.22, 0}, {0, 0.88, 0}, thick, thick * 0.95, Main), 9));
    const auto add_arm = [&](double side, double elbow, double tip, double out) {
        const Vec3 corner{side * out, elbow, -0.02};
        s.push_back(ribbed(capsule({side * 0.05, elbow - 0.03, 0}, corner, 0.075, 0.085, Main), 7));
        s.push_back(ribbed(capsule(corner, corner + Vec3{0, tip - elbow, 0}, 0.085, 0.078, Main), 7));
    };
    add_arm(-flip, left, left + 0.22, 0.31);
    add_arm(flip, right - 0.1, right + 0.2, 0.28);
    const Vec3 flower{-flip * 0.31, left + 0.29, -0.02};
    for (int i = 0; i < 5; ++i) {
        const double angle = Circle * i / 5;
        s.push_back(finer(ellipsoid(flower + Vec3{0.04 * std::cos(angle), 0.01, 0.04 * std::sin(angle)},
                                    {0.035, 0.03, 0.035}, blossom),
                          2));
    }
    model.anchor = {.top = {0, 0.88 + thick * 0.93, 0},
                    .head_radius = 0.17,
                    .eyes = {0, 0.8, -thick - 0.005},
                    .eye_half = 0.1,
                    .face_depth = 0.17,
                    .neck = {0, 0.63, 0},
                    .neck_x = thick + 0.01,
                    .neck_z = thick + 0.01,
                    .back = {0, 0.55, thick},
                    .body_radius = 0.37,
                    .body_depth = 0.27};
    return model;
}

Model make_teapot(Random& random) {
    const double belly = random.uniform(0.295, 0.33);
    const double tall = random.uniform(0.94, 1.06);
    const double spout = random.uniform(0.53, 0.59);
    Model model;
    auto& s = model.shapes;
    std::vector<ProfilePoint> profile{{0, 0}, {0.19, 0}, {0.2, 0.035}};
    constexpr int Steps = 10;
    for (int i = 0; i <= Steps; ++i) {
        const double angle = -1.0 + 2.1 * i / Steps;
        profile.push_back({belly * std::cos(angle) * 1.02, 0.32 * tall + 0.31 * tall * std::sin(angle)});
    }
    profile.push_back({0, 0.6 * tall});
    Shape body = revolution({0, 0, 0}, profile, Main);
    body.paint_at = [tall](const SurfacePoint& point) {
        return std::abs(point.position.y - 0.33 * tall) < 0.045 ? Pale : Main;
    };
    s.push_back(body);
    const double lid = 0.595 * tall;
    s.push_back(revolution({0, lid, 0}, {{0, -0.02}, {0.19, -0.02}, {0.195, 0.02}, {0, 0.03}}, Deep));
    s.push_back(
        revolution({0, lid, 0}, {{0, 0.01}, {0.17, 0.015}, {0.14, 0.07}, {0.07, 0.11}, {0, 0.12}}, Main));
    s.push_back(ellipsoid({0, lid + 0.155, 0}, {0.065, 0.06, 0.065}, Deep));
    const Vec3 path[] = {
        {belly * 0.75, 0.2, 0}, {belly + 0.09, 0.3, 0}, {belly + 0.15, 0.46, 0}, {belly + 0.22, spout, 0}};
    const double radii[] = {0.125, 0.095, 0.07, 0.055};
    for (int i = 0; i < 3; ++i) s.push_back(capsule(path[i], path[i + 1], radii[i], radii[i + 1], Main));
    const Vec3 along = normalized(path[3] - path[2]);
    s.push_back(finer(cone(path[3], path[3] + along * 0.055, 0.066, 0.075, Deep), 2));
    constexpr int Pieces = 7;
    Vec3 from{-belly * 0.8, 0.53 * tall, 0};
    for (int i = 1; i <= Pieces; ++i) {
        const double angle = 3.14159265 * (0.5 + static_cast<double>(i) / Pieces);
        const Vec3 to{-belly * 0.8 + 0.25 * std::cos(angle), 0.365 * tall + 0.165 * tall * std::sin(angle),
                      0};
        s.push_back(capsule(from, to, 0.04, 0.04, Main));
        from = to;
    }
    model.anchor = {.top = {0, lid + 0.13, 0},
                    .head_radius = 0.2,
                    .eyes = {0, 0.44 * tall, -belly * 0.97},
                    .eye_half = 0.13,
                    .face_depth = 0.28,
                    .neck = {0, 0.15, 0},
                    .neck_x = belly * 0.86,
                    .neck_z = belly * 0.86,
                    .back = {0, 0.42, belly * 0.95},
                    .body_radius = belly + 0.16,
                    .body_depth = belly};
    return model;
}

Model make_rocket(Random& random) {
    const double belly = random.uniform(0.185, 0.22);
    const double reach = random.uniform(0.36, 0.42);
    const double tip = random.uniform(0.7, 0.76);
    const Paint glass{Slot::Fixed, {0.2, 0.5, 0.85}};
    Model model;
    auto& s = model.shapes;
    const auto radius_at = [belly](double y) {
        const double t = y < 0.42 ? (0.42 - y) / 0.42 : (y - 0.42) / 0.63;
        return y < 0.42 ? belly * (1 - 0.4 * t * t) : belly * (1 - std::pow(t, 1.9));
    };
    std::vector<ProfilePoint> profile{{0, 0.13}};
    constexpr int Steps = 16;
    for (int i = 0; i <= Steps; ++i) {
        const double y = 0.13 + 0.92 * i / Steps;
        profile.push_back({std::max(0.0, radius_at(y)), y});
    }
    Shape body = revolution({0, 0, 0}, profile, Main);
    body.paint_at = [tip](const SurfacePoint& point) {
        const double y = point.position.y;
        if (y > tip + 0.03) return Deep;
        return y > tip || std::abs(y - 0.3) < 0.02 ? Pale : Main;
    };
    s.push_back(body);
    s.push_back(revolution({0, 0, 0}, {{0, 0.05}, {0.13, 0.04}, {0.085, 0.15}, {0, 0.15}},
                           {Slot::Fixed, {0.16, 0.16, 0.18}}));
    for (int i = 0; i < 4; ++i) {
        s.push_back(rocket_fin(Circle * (i + 0.5) / 4, reach));
        const double angle = Circle * i / 4;
        const double y = i % 2 == 0 ? 0.59 : 0.48;
        const double size = i % 2 == 0 ? 0.085 : 0.07;
        const Vec3 out{std::sin(angle), 0, -std::cos(angle)};
        const Vec3 at = out * (radius_at(y) - 0.008) + Vec3{0, y, 0};
        s.push_back(plate(at, out, size, 0.03, Pale));
        s.push_back(plate(at + out * 0.015, out, size * 0.7, 0.03, glass));
    }
    const Vec3 low{0, 0.4, -radius_at(0.4) + 0.008};
    s.push_back(plate(low, {0, 0, -1}, 0.06, 0.03, Pale));
    s.push_back(plate(low + Vec3{0, 0, -0.015}, {0, 0, -1}, 0.04, 0.03, glass));
    model.anchor = {.top = {0, 0.93, 0},
                    .head_radius = 0.16,
                    .eyes = {0, 0.69, -radius_at(0.69) - 0.015},
                    .eye_half = 0.11,
                    .face_depth = 0.2,
                    .neck = {0, 0.45, 0},
                    .neck_x = belly + 0.005,
                    .neck_z = belly + 0.005,
                    .back = {0, 0.5, belly},
                    .body_radius = 0.3,
                    .body_depth = 0.3};
    return model;
}

Model make_castle(Random& random) {
    const double w = random.uniform(0.29, 0.33);
    const double wall = random.uniform(0.29, 0.34);
    const double keep = random.uniform(0.78, 0.86);
    const double tower = random.uniform(0.48, 0.54);
    const double d = w * 0.9;
    Model model;
    auto& s = model.shapes;
    s.push_back(box({0, wall * 0.5, 0}, {w, wall * 0.5, d}, Main));
    s.push_back(box({0, keep * 0.5, 0.02}, {0.155, keep * 0.5, 0.14}, Main));
    constexpr double Tooth = 0.042;
    for (const double side : {-1.0, 1.0}) {
        for (const double along : {-0.13, 0.0, 0.13}) {
            s.push_back(box({along, wall + 0.03, side * (d - 0.03)}, {Tooth, 0.04, 0.035}, Main));
            s.push_back(box({side * (w - 0.03), wall + 0.03, along}, {0.035, 0.04, Tooth}, Main));
        }
        for (const double end : {-1.0, 1.0}) {
            const double x = side * w;
            const double z = end * d;
            s.push_back(box({side * 0.135, keep + 0.035, 0.02 + end * 0.12}, {0.05, 0.06, 0.05}, Pale));
            s.push_back(cone({x, 0, z}, {x, tower, z}, 0.105, 0.09, Main));
            s.push_back(cone({x, tower - 0.02, z}, {x, tower + 0.24, z}, 0.135, 0.008, Deep));
            s.push_back(finer(box({x, tower - 0.13, z + end * 0.09}, {0.024, 0.055, 0.02}, Coal), 3));
        }
        s.push_back(finer(box({side * 0.07, keep - 0.14, -0.122}, {0.03, 0.065, 0.012}, Coal), 3));
        s.push_back(finer(box({side * 0.16, keep - 0.14, 0.02}, {0.012, 0.06, 0.03}, Coal), 3));
    }
    s.push_back(finer(box({0, 0.17, -d - 0.005}, {0.125, 0.17, 0.012}, Pale), 1.5));
    s.push_back(finer(box({0, 0.09, -d - 0.015}, {0.09, 0.09, 0.015}, Coal), 2.5));
    s.push_back(plate({0, 0.18, -d - 0.014}, {0, 0, -1}, 0.09, 0.016, Coal));
    model.anchor = {.top = {0, keep + 0.075, 0.02},
                    .head_radius = 0.2,
                    .eyes = {0, keep - 0.14, -0.15},
                    .eye_half = 0.11,
                    .face_depth = 0.2,
                    .neck = {0, 0.5 * (wall + keep) - 0.04, 0.02},
                    .neck_x = 0.165,
                    .neck_z = 0.155,
                    .back = {0, 0.52, 0.17},
                    .body_radius = w + 0.13,
                    .body_depth = d + 0.13};
    return model;
}

Model make_lamp(Random& random) {
    const double wide = random.uniform(0.35, 0.4);
    const double narrow = random.uniform(0.17, 0.22);
    const double foot = random.uniform(0.19, 0.23);
    const double low = random.uniform(0.57, 0.62);
    const Paint light{Slot::Glow, {1.0, 0.92, 0.55}};
    Model model;
    auto& s = model.shapes;
    s.push_back(revolution(
        {0, 0, 0}, {{0, 0}, {foot, 0}, {foot, 0.04}, {foot * 0.8, 0.075}, {0.05, 0.1}, {0, 0.11}}, Deep));
    s.push_back(cone({0, 0.08, 0}, {0, 0.7, 0}, 0.035, 0.03, Main));
    s.push_back(ellipsoid({0, 0.25, 0}, {0.1, 0.13, 0.1}, Main));
    s.push_back(ellipsoid({0, 0.4, 0}, {0.06, 0.035, 0.06}, Deep));
    constexpr double Top = 0.98;
    Shape shade = revolution({0, 0, 0}, {{0, low}, {wide, low}, {narrow, Top}, {0, Top - 0.02}}, Main);
    shade.paint_at = [=](const SurfacePoint& point) {
        const double y = point.position.y;
        if (point.v < 0.32) return light;  // the underside
        return y < low + 0.03 || y > Top - 0.045 ? Pale : Main;
    };
    s.push_back(shade);
    s.push_back(finer(
        revolution({0, 0, 0},
                   {{0, low - 0.06}, {wide * 0.86, low - 0.06}, {wide * 0.94, low + 0.005}, {0, low + 0.01}},
                   light),
        1.5));
    s.push_back(ellipsoid({0, low - 0.06, 0}, {0.11, 0.075, 0.11}, light));
    s.push_back(capsule({0, Top - 0.02, 0}, {0, Top + 0.03, 0}, 0.03, 0.03, Deep));
    const Vec3 cord{wide * 0.6, low - 0.02, -0.12};
    s.push_back(capsule(cord, cord - Vec3{0, 0.12, 0}, 0.011, 0.011, Deep));
    s.push_back(ellipsoid(cord - Vec3{0, 0.14, 0}, {0.028, 0.032, 0.028}, Deep));
    const double face = 0.5 * (low + Top);
    model.anchor = {.top = {0, Top + 0.01, 0},
                    .head_radius = narrow + 0.02,
                    .eyes = {0, face, -0.5 * (wide + narrow) - 0.005},
                    .eye_half = 0.125,
                    .face_depth = 0.28,
                    .neck = {0, 0.42, 0},
                    .neck_x = 0.1,
                    .neck_z = 0.1,
                    .back = {0, 0.6, wide * 0.9},
                    .body_radius = wide,
                    .body_depth = wide};
    return model;
}

}  // namespace gse::synth
