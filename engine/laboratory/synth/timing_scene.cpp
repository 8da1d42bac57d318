// Splats scattered over simple surfaces; sizes, opacities and colours drawn from the mixtures below.
#include "engine/laboratory/synth/timing_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "engine/base/random.h"

namespace gse::synth {
namespace {

constexpr double Turn = 2 * std::numbers::pi;
constexpr double ShConstant = 0.28209479177387814;
constexpr int ShCoefficients = 16;

struct Spot {
    Vec3 position, normal;
};

Spot on_sphere(Random& random, const Vec3& centre, double radius) {
    const Vec3 normal = normalized(Vec3{random.normal(), random.normal(), random.normal()});
    return {centre + radius * normal, normal};
}

Spot on_torus(Random& random, const Vec3& centre, double ring, double tube) {
    const double u = random.uniform(0, Turn);
    double w = random.uniform(0, Turn);
    while (random.uniform(0, ring + tube) >= ring + tube * std::cos(w)) w = random.uniform(0, Turn);
    const Vec3 normal{std::cos(u) * std::cos(w), std::sin(w), std::sin(u) * std::cos(w)};
    return {centre + Vec3{ring * std::cos(u), 0, ring * std::sin(u)} + tube * normal, normal};
}

Spot on_box(Random& random, const Vec3& centre, const Vec3& half) {
    const double x = half.y * half.z, y = half.x * half.z, z = half.x * half.y;
    const double pick = random.uniform(0, x + y + z);
    const int face = pick < x ? 0 : pick < x + y ? 1 : 2;
    const double side = random.below(2) == 0 ? -1 : 1;
    Vec3 offset{random.uniform(-half.x, half.x), random.uniform(-half.y, half.y),
                random.uniform(-half.z, half.z)};
    Vec3 normal;
    normal[face] = side;
    offset[face] = side * half[face];
    return {centre + offset, normal};
}

Spot on_cone(Random& random, const Vec3& base, double radius, double height) {
    const double t = 1 - std::sqrt(random.uniform()), u = random.uniform(0, Turn), r = radius * (1 - t);
    return {base + Vec3{r * std::cos(u), height * t, r * std::sin(u)},
            normalized(Vec3{height * std::cos(u), radius, height * std::sin(u)})};
}

Spot on_ground(Random& random, double radius) {
    const double u = random.uniform(0, Turn), r = radius * std::sqrt(random.uniform());
    return {{r * std::cos(u), 0.03 * std::sin(3 * r) * std::cos(2 * u), r * std::sin(u)}, {0, 1, 0}};
}

struct Surface {
    double share;  // of the splats; the first surface takes what rounding leaves
    double area;
    Spot (*spot)(Random&);
    Vec3 colour;
};

std::span<const Surface> surfaces() {
    constexpr double pi = std::numbers::pi;
    static const std::array list{
        Surface{.16,
                4 * pi,
                [](Random& r) {
                    return on_sphere(r, {0, 1, 0}, 1);
                },
                {.85, .25, .2}},
        Surface{.14,
                4 * pi * pi * .9 * .35,
                [](Random& r) {
                    return on_torus(r, {2.3, .45, .4}, .9, .35);
                },
                {.2, .55, .85}},
        Surface{.14,
                8 * (.6 * .7 * 2 + .36),
                [](Random& r) {
                    return on_box(r, {-2.2, .7, .3}, {.6, .7, .6});
                },
                {.95, .75, .2}},
        Surface{.10,
                pi * .7 * 1.75,
                [](Random& r) {
                    return on_cone(r, {.2, 0, 2.2}, .7, 1.6);
                },
                {.3, .75, .35}},
        Surface{.08,
                pi,
                [](Random& r) {
                    return on_sphere(r, {-.8, .5, -2}, .5);
                },
                {.7, .35, .8}},
        Surface{.30, pi * 49, [](Random& r) { return on_ground(r, 7); }, {.45, .42, .38}},
        Surface{.08, 4 * pi * 196, [](Random& r) { return on_sphere(r, {}, 14); }, {.6, .75, .95}}};
    return list;
}

/// Flat discs around 0.45 of the spacing, one in a hundred 3.3 times larger.
Vec3 log_scales(Random& random, double spacing) {
    const double base = std::log(0.45 * spacing) + 0.75 * random.normal();
    const double extra = random.uniform() < 0.01 ? 1.2 : 0;
    return {base + .25 + .45 * random.normal() + extra, base - .25 + .45 * random.normal() + extra,
            base + std::log(.18) + .5 * random.normal() + extra};
}

double opacity_logit(Random& random) {
    const double pick = random.uniform();
    return (pick < 0.5 ? -1.7 : pick < 0.75 ? 0.8 : 4.5) + 1.2 * random.normal();
}

/// Axes of the disc, turned by a random angle in the surface, as the columns of a rotation.
Quat orientation(Random& random, const Vec3& normal) {
    const Vec3 other = std::abs(normal.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    const Vec3 t = normalized(cross(normal, other)), b = cross(normal, t);
    const double angle = random.uniform(0, Turn);
    const Vec3 x = std::cos(angle) * t + std::sin(angle) * b, y = cross(normal, x);
    return quaternion(Mat3::from_columns(x, y, normal));
}

/// A checkered texture in the constant part, noise that falls with the degree in the rest.
void fill_sh(Random& random, const Vec3& at, const Vec3& colour, float* sh) {
    const double wave = .5 + .5 * std::sin(9 * at.x) * std::sin(9 * at.y + 1) * std::sin(9 * at.z);
    for (int c = 0; c < 3; ++c) {
        const double value = std::clamp(colour[c] * (.55 + .6 * wave) + .06 * random.normal(), 0.0, 1.0);
        sh[c] = static_cast<float>((value - 0.5) / ShConstant);
    }
    for (int k = 1; k < ShCoefficients; ++k)
        for (int c = 0; c < 3; ++c)
            sh[k * 3 + c] = static_cast<float>((k < 4 ? .09 : k < 9 ? .05 : .03) * random.normal());
}

void fill_row(Random& random, const Surface& surface, double spacing, std::size_t row, GaussianData& data) {
    const Spot spot = surface.spot(random);
    const Vec3 position = spot.position + spot.normal * (.15 * spacing * random.normal());
    const Vec3 scale = log_scales(random, spacing);
    const Quat q = orientation(random, spot.normal);
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = row * 3 + static_cast<std::size_t>(axis);
        data.position[at] = static_cast<float>(position[axis]);
        data.log_scale[at] = static_cast<float>(scale[axis]);
    }
    const std::array rotation{q.w, q.x, q.y, q.z};
    std::transform(rotation.begin(), rotation.end(), &data.rotation[row * 4],
                   [](double v) { return static_cast<float>(v); });
    data.opacity_logit[row] = static_cast<float>(opacity_logit(random));
    fill_sh(random, position, surface.colour, &data.sh[row * data.sh_stride()]);
}

}  // namespace

Scene timing_scene(std::size_t count, std::uint64_t seed) {
    GaussianData data;
    data.sh_degree = 3;
    data.resize(count);
    const auto list = surfaces();
    std::size_t row = 0;
    for (std::size_t i = list.size(); i-- > 0;) {
        const auto rows =
            i == 0 ? count - row : static_cast<std::size_t>(static_cast<double>(count) * list[i].share);
        Random random = Random::stream(seed, i);
        const double spacing = std::sqrt(list[i].area / static_cast<double>(std::max<std::size_t>(rows, 1)));
        for (const std::size_t end = row + rows; row < end; ++row)
            fill_row(random, list[i], spacing, row, data);
    }
    Scene scene;
    scene.gaussians = GaussianSet(std::move(data));
    scene.info.format = "synthetic";
    scene.info.up = {0, 1, 0};
    scene.info.up_known = true;
    return scene;
}

std::vector<Camera> timing_cameras(int count, int width, int height) {
    constexpr double distance = 6.5, above = 2.2;
    OrbitParameters orbit;
    orbit.centre = {0, 0.6, 0};
    orbit.up = {0, 1, 0};
    orbit.radius = std::hypot(distance, above);
    orbit.elevation = std::atan2(above, distance);
    orbit.fov_x = std::numbers::pi / 3;
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) cameras.push_back(orbit_camera(orbit, Turn * i / count, width, height));
    return cameras;
}

}  // namespace gse::synth
