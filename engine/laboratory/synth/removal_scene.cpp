// Textured sheets and a thing of the synthetic world, with a contact shadow by the distance to the thing.
#include "engine/laboratory/synth/removal_scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/base/error.h"
#include "engine/laboratory/synth/objects/ground.h"
#include "engine/laboratory/synth/objects/models.h"
#include "engine/math/sh.h"

namespace gse::synth {
namespace {

constexpr double SurroundingShare = 0.7;  // of the rows
constexpr double ShadowReach = 0.14;      // model units, from the thing
constexpr double ShadowDepth = 0.75;

using Texture = std::function<Vec3(const Vec3&)>;

/// Rectangle from a corner, in model space (y up), with a height added along its normal.
struct Panel {
    Vec3 corner, along, across, normal;
    Texture texture;
    std::function<double(const Vec3&)> lift = {};
    double area() const { return length(along) * length(across); }
};

/// Whole rows of a part before they are written.
struct Sheet {
    std::vector<SurfacePoint> points;
    std::vector<Vec3> colours;
};

Texture stripes(const Vec3& direction, double period, const Vec3& a, const Vec3& b, const Vec3& offset) {
    return [=](const Vec3& p) {
        const double wave = std::sin(2 * std::numbers::pi * dot(p, direction) / period);
        return mix(a, b, smooth_step(-0.3, 0.3, wave)) * (0.9 + 0.2 * value_noise(p * 9.0 + offset));
    };
}

Texture checks(double side, const Vec3& a, const Vec3& b) {
    return [=](const Vec3& p) {
        const auto cell = [side](double v) { return static_cast<long>(std::floor(v / side + 0.25)); };
        return ((cell(p.x) + cell(p.y + 1e-3) + cell(p.z)) & 1) == 0 ? a : b;
    };
}

Texture mottled(const Vec3& a, const Vec3& b, double fineness, const Vec3& offset) {
    return [=](const Vec3& p) {
        return mix(a, b, smooth_step(0.25, 0.75, layered_noise(p * fineness + offset))) *
               (0.85 + 0.3 * value_noise(p * 14.0 + offset));
    };
}

void add_panel(const Panel& panel, double spacing, Random& random, Sheet& sheet) {
    const auto count = [&](const Vec3& side) {
        return std::max(1, static_cast<int>(std::lround(length(side) / spacing)));
    };
    const int columns = count(panel.along), lines = count(panel.across);
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < lines; ++j) {
            SurfacePoint point;
            const double u = (i + 0.5 + random.uniform(-0.3, 0.3)) / columns;
            const double v = (j + 0.5 + random.uniform(-0.3, 0.3)) / lines;
            point.position = panel.corner + panel.along * u + panel.across * v;
            point.normal = panel.normal;
            const Vec3 colour = panel.texture(point.position);
            if (panel.lift) {
                constexpr double Step = 1e-3;
                const double h = panel.lift(point.position);
                const Vec3 a = normalized(panel.along), b = normalized(panel.across);
                point.normal =
                    normalized(panel.normal - a * ((panel.lift(point.position + a * Step) - h) / Step) -
                               b * ((panel.lift(point.position + b * Step) - h) / Step));
                point.position += panel.normal * h;
            }
            point.spacing = spacing;
            sheet.points.push_back(point);
            sheet.colours.push_back(colour);
        }
}

/// Kind of a scene: its panels, where the thing stands, what else is there.
struct Layout {
    std::vector<Panel> panels;
    std::string ground;  // word of a ground of the synthetic world, in place of panels
    Vec3 place;          // of the thing
    double size = 0.8;   // of the thing
    double widest = std::numbers::pi;
    bool other = false;  // another thing stands half before it
};

Panel floor_panel(double half, const Texture& texture) {
    return {{-half, 0, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}, {0, 1, 0}, texture};
}

/// Upright faces of a box around the origin, from `low` to `high`.
void add_sides(Layout& layout, double half_x, double half_z, double low, double high,
               const Texture& texture) {
    const Vec3 rise{0, high - low, 0};
    layout.panels.push_back({{-half_x, low, -half_z}, {2 * half_x, 0, 0}, rise, {0, 0, -1}, texture});
    layout.panels.push_back({{-half_x, low, half_z}, {2 * half_x, 0, 0}, rise, {0, 0, 1}, texture});
    layout.panels.push_back({{-half_x, low, -half_z}, {0, 0, 2 * half_z}, rise, {-1, 0, 0}, texture});
    layout.panels.push_back({{half_x, low, -half_z}, {0, 0, 2 * half_z}, rise, {1, 0, 0}, texture});
}

Layout layout_of(const std::string& name, Random& random) {
    const Vec3 offset{random.uniform(0, 9), random.uniform(0, 9), random.uniform(0, 9)};
    const Texture wood =
        stripes(normalized(Vec3{1, 0, 0.3}), 0.17, {0.62, 0.42, 0.24}, {0.45, 0.28, 0.15}, offset);
    const Texture tiles = checks(0.2, {0.82, 0.80, 0.74}, {0.40, 0.45, 0.52});
    const Texture paper = stripes({0.7, 0.7, 0}, 0.24, {0.80, 0.72, 0.58}, {0.55, 0.60, 0.52}, offset);
    const Texture plaster = mottled({0.72, 0.62, 0.50}, {0.50, 0.42, 0.36}, 3.0, offset);
    const Texture stone = mottled({0.62, 0.62, 0.60}, {0.36, 0.38, 0.40}, 4.0, offset);
    Layout layout;
    layout.place = {random.uniform(-0.1, 0.1), 0, random.uniform(-0.1, 0.1)};
    if (name == "grass" || name == "sand" || name == "tiles") {
        layout.ground = name;
    } else if (name == "table") {
        layout.panels = {{{-0.9, 0, -0.6}, {1.8, 0, 0}, {0, 0, 1.2}, {0, 1, 0}, wood}};
        add_sides(layout, 0.9, 0.6, -0.15, 0, plaster);
        Panel floor = floor_panel(1.8, tiles);
        floor.corner.y = -0.8;
        layout.panels.push_back(floor);
        layout.place = {layout.place.x, 0, -0.36};
        layout.size = 0.6;
    } else if (name == "wall" || name == "corner") {
        layout.panels = {floor_panel(1.5, tiles)};
        layout.panels.push_back({{-1.5, 0, 0.42}, {3, 0, 0}, {0, 1.8, 0}, {0, 0, -1}, paper});
        layout.panels[0].across = {0, 0, 1.92};
        if (name == "corner") {
            layout.panels.push_back({{0.55, 0, -1.5}, {0, 0, 1.92}, {0, 1.8, 0}, {-1, 0, 0}, plaster});
            layout.panels[0].along = {2.05, 0, 0};
            layout.panels[1].along = {2.05, 0, 0};
        }
        layout.place = {0.08, 0, 0.04};
        layout.size = 0.75;
        layout.widest = 1.1;
    } else if (name == "behind") {
        layout.panels = {floor_panel(1.6, wood)};
        layout.other = true;
    } else if (name == "mound") {
        layout.panels = {floor_panel(1.6, stone)};
        layout.panels[0].lift = [](const Vec3& p) { return 0.45 * std::exp(-(p.x * p.x + p.z * p.z) / 0.6); };
        layout.place.y = 0.40;
        layout.size = 0.6;
    } else if (name == "plinth") {
        layout.panels = {{{-0.42, 0, -0.42}, {0.84, 0, 0}, {0, 0, 0.84}, {0, 1, 0}, stone}};
        add_sides(layout, 0.42, 0.42, -0.5, 0, stone);
        Panel floor = floor_panel(1.6, wood);
        floor.corner.y = -0.5;
        layout.panels.push_back(floor);
        layout.size = 0.6;
    } else {
        throw Error(ErrorCode::InvalidArgument, "there is no kind of removal scene \"" + name + "\"");
    }
    return layout;
}

Sheet make_thing(const std::string& word, const std::string& material, const Vec3& place, double size,
                 int count, std::uint64_t seed) {
    const Model model = make_object(word, Random::stream(seed, 11));
    const Material look = make_material(material, Random::stream(seed, 12));
    const Light light = make_light(Random::stream(seed, 13));
    Sheet sheet;
    sheet.points = sample_surface(model.shapes, {}, count, Random::stream(seed, 14));
    for (auto& point : sheet.points) {
        const Shape& shape = model.shapes[point.shape];
        sheet.colours.push_back(
            shade(shape.paint_at ? shape.paint_at(point) : shape.paint, look, light, point));
        point.position = point.position * size + place;
        point.spacing *= size;
    }
    return sheet;
}

/// Factors of the colours at a place, in the shadow of the thing.
Vec3 shadow_at(const Vec3& place, const Sheet& thing, double reach) {
    double nearest = 1e30;
    for (const auto& point : thing.points) {
        const Vec3 d = point.position - place;
        nearest = std::min(nearest, dot(d, d));
    }
    return mix({1, 1, 1}, {0.40, 0.42, 0.50}, ShadowDepth * std::exp(-nearest / (reach * reach)));
}

/// Colours of the sheet in the shadow of the thing.
std::vector<Vec3> shaded(const Sheet& sheet, const Sheet& thing) {
    auto colours = sheet.colours;
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours[i] *= shadow_at(sheet.points[i].position, thing, ShadowReach);
    return colours;
}

void append(const Sheet& sheet, std::span<const Vec3> colours, Random random, GaussianData& data) {
    constexpr double Along = 0.72, Across = 0.62, Through = 0.10;  // standard deviations over the spacing
    for (std::size_t i = 0; i < sheet.points.size(); ++i) {
        const SurfacePoint& point = sheet.points[i];
        const Vec3& p = point.position;
        const Vec3& n = point.normal;
        const Quat turn = quaternion(rotation_to(Vec3{-n.x, -n.y, n.z}));
        const double opacity = random.uniform(0.92, 0.97);
        for (const double value : {-p.x, -p.y, p.z}) data.position.push_back(static_cast<float>(value));
        for (const double factor : {Along, Through, Across})
            data.log_scale.push_back(static_cast<float>(std::log(factor * point.spacing)));
        for (const double value : {turn.w, turn.x, turn.y, turn.z})
            data.rotation.push_back(static_cast<float>(value));
        data.opacity_logit.push_back(static_cast<float>(std::log(opacity / (1 - opacity))));
        for (int c = 0; c < 3; ++c)
            data.sh.push_back(static_cast<float>(sh_from_colour(std::clamp(colours[i][c], 0.0, 1.0))));
    }
}

Sheet make_surroundings(const Layout& layout, int count, std::uint64_t seed) {
    Sheet sheet;
    if (!layout.ground.empty()) {
        auto ground = make_ground(layout.ground, count, {}, make_light(Random::stream(seed, 13)),
                                  Random::stream(seed, 15));
        return {std::move(ground.points), std::move(ground.colours)};
    }
    double area = 0;
    for (const auto& panel : layout.panels) area += panel.area();
    Random random = Random::stream(seed, 16);
    for (const auto& panel : layout.panels) add_panel(panel, std::sqrt(area / count), random, sheet);
    return sheet;
}

}  // namespace

Camera RemovalScene::camera(double share, double elevation, int width, int height) const {
    OrbitParameters at = orbit;
    at.elevation = elevation;
    return orbit_camera(at, (2 * share - 1) * widest_azimuth, width, height);
}

const std::vector<std::string>& removal_scene_names() {
    static const std::vector<std::string> names{"grass",  "sand",   "tiles", "table", "wall",
                                                "corner", "behind", "mound", "plinth"};
    return names;
}

RemovalScene removal_scene(const std::string& name, std::uint64_t seed, int gaussians) {
    Random random = Random::stream(seed, 10);
    const Layout layout = layout_of(name, random);
    const int around = static_cast<int>(SurroundingShare * gaussians), rest = gaussians - around;
    const std::vector<std::string> words{"bear", "dog", "cat", "duck", "statue", "vase"};
    const auto& word = words[random.below(words.size())];
    Sheet surroundings = make_surroundings(layout, around, seed);
    const Sheet thing = make_thing(word, "red", layout.place, layout.size, rest, seed);
    if (layout.other) {
        const Sheet other =
            make_thing("mushroom", "blue", layout.place + Vec3{0.45, 0, -0.35}, 0.6, rest / 2, seed + 1);
        surroundings.points.insert(surroundings.points.end(), other.points.begin(), other.points.end());
        surroundings.colours.insert(surroundings.colours.end(), other.colours.begin(), other.colours.end());
    }
    GaussianData truth, scene;
    append(surroundings, surroundings.colours, Random::stream(seed, 17), truth);
    append(surroundings, shaded(surroundings, thing), Random::stream(seed, 17), scene);
    append(thing, thing.colours, Random::stream(seed, 18), scene);
    RemovalScene result;
    result.name = name;
    result.thing.assign(scene.size(), 0);
    std::fill(result.thing.begin() + static_cast<std::ptrdiff_t>(truth.size()), result.thing.end(), 1);
    result.scene = GaussianSet(std::move(scene));
    result.truth = GaussianSet(std::move(truth));
    const Vec3& p = layout.place;
    result.orbit.centre = {-p.x, -p.y - 0.3 * layout.size, p.z};
    result.orbit.radius = 2.0;
    result.orbit.fov_x = 0.8;
    result.widest_azimuth = layout.widest;
    return result;
}

RemovalScene removal_scene_on(const GaussianSet& surroundings, const Vec3& up, const Vec3& place, double size,
                              std::uint64_t seed) {
    constexpr int ThingRows = 6000;
    // Model space to the scene: y goes along up.
    const Mat3 turn = rotation_to(normalized(up));
    Sheet thing = make_thing("bear", "red", {}, size, ThingRows, seed);
    GaussianData drawn, scene = surroundings.to_data();
    append(thing, thing.colours, Random::stream(seed, 18), drawn);
    const Quat spin = quaternion(turn) * Quat(0, 0, 0, 1);  // undoes the half turn about z of append()
    for (std::size_t row = 0; row < drawn.size(); ++row) {
        thing.points[row].position = turn * thing.points[row].position + place;
        const float* q = &drawn.rotation[row * 4];
        const Quat turned = spin * Quat(q[0], q[1], q[2], q[3]);
        const std::size_t to = scene.size();
        scene.resize(to + 1);
        for (std::size_t k = 0; k < 3; ++k) {
            scene.position[to * 3 + k] = static_cast<float>(thing.points[row].position[static_cast<int>(k)]);
            scene.log_scale[to * 3 + k] = drawn.log_scale[row * 3 + k];
            scene.sh[to * scene.sh_stride() + k] = drawn.sh[row * 3 + k];
        }
        const double rotation[4] = {turned.w, turned.x, turned.y, turned.z};
        for (std::size_t k = 0; k < 4; ++k) scene.rotation[to * 4 + k] = static_cast<float>(rotation[k]);
        scene.opacity_logit[to] = drawn.opacity_logit[row];
    }
    for (std::size_t row = 0; row < surroundings.size(); ++row) {
        const Vec3 at{scene.position[row * 3], scene.position[row * 3 + 1], scene.position[row * 3 + 2]};
        if (!(length(at - place) < 2 * size)) continue;
        const Vec3 shadow = shadow_at(at, thing, ShadowReach * size);
        float* sh = &scene.sh[row * scene.sh_stride()];
        for (std::size_t k = 0; k < scene.sh_stride(); ++k) {
            const double factor = shadow[static_cast<int>(k % 3)];
            sh[k] =
                static_cast<float>(k < 3 ? sh_from_colour(colour_from_sh(sh[k]) * factor) : sh[k] * factor);
        }
    }
    RemovalScene result;
    result.name = "scan";
    result.thing.assign(scene.size(), 0);
    std::fill(result.thing.begin() + static_cast<std::ptrdiff_t>(surroundings.size()), result.thing.end(), 1);
    result.truth = surroundings;
    result.scene = GaussianSet(std::move(scene));
    result.up = normalized(up);
    result.orbit.centre = place + result.up * (0.3 * size);
    result.orbit.up = result.up;
    result.orbit.radius = 2.6 * size;
    result.orbit.fov_x = 0.8;
    result.widest_azimuth = std::numbers::pi;
    return result;
}

}  // namespace gse::synth
