// Procedural materials and the baked light model.
#include "engine/synth/materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::synth {
namespace {

struct PlainColour {
    const char* word;
    Vec3 colour;
};

constexpr std::array<PlainColour, 8> PlainColours{{
    {"red", {0.85, 0.07, 0.07}},
    {"blue", {0.10, 0.22, 0.88}},
    {"green", {0.03, 0.55, 0.16}},
    {"yellow", {0.99, 0.88, 0.08}},
    {"purple", {0.52, 0.12, 0.72}},
    {"orange", {0.98, 0.47, 0.04}},
    {"black", {0.09, 0.09, 0.10}},
    {"white", {0.95, 0.95, 0.94}},
}};

double lattice(std::int64_t x, std::int64_t y, std::int64_t z) {
    auto h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL +
             static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL +
             static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL;
    h ^= h >> 29;
    h *= 0xbf58476d1ce4e5b9ULL;
    h ^= h >> 32;
    return static_cast<double>(h >> 11) * 0x1.0p-53;
}

double bell(double x, double centre, double width) {
    const double t = (x - centre) / width;
    return std::exp(-t * t);
}

Vec3 clamp01(const Vec3& c) {
    return {std::clamp(c.x, 0.0, 1.0), std::clamp(c.y, 0.0, 1.0), std::clamp(c.z, 0.0, 1.0)};
}

Vec3 wood(const Material& material, const Vec3& p) {
    // Rings around a slightly leaning trunk axis, bent by noise.
    const Vec3 q = p + material.offset;
    const double bend = layered_noise(q * 3.0) - 0.5;
    const double radius = std::hypot(p.x + 0.25 * p.y + 0.13, p.z - 0.15 * p.y + 0.31);
    const double ring = 0.5 + 0.5 * std::sin(6.2831853 * (radius / 0.10 + 1.4 * bend));
    const double fibre = value_noise({q.x * 45, q.y * 5, q.z * 45});
    const Vec3 colour = mix({0.72, 0.46, 0.22}, {0.33, 0.17, 0.06}, smooth_step(0.35, 0.9, ring));
    return colour * (0.85 + 0.3 * fibre);
}

Vec3 stone(const Material& material, const Vec3& p) {
    const Vec3 q = p + material.offset;
    const double blotch = layered_noise(q * 6.0);
    const double speckle = value_noise(q * 38.0);
    double grey = 0.28 + 0.5 * blotch;
    if (speckle > 0.74) grey += 0.25;
    if (speckle < 0.24) grey -= 0.22;
    return Vec3{1.0, 0.98, 0.94} * std::clamp(grey, 0.12, 0.9);
}

/// Polished metal: bands of a fixed surrounding (bright sky, dark horizon, warm ground) mirrored by the
/// normal.
Vec3 gold(const Material& material, const Light& light, const SurfacePoint& point) {
    const Vec3 q = (point.position + material.offset) * 4.0;
    const Vec3 dent{value_noise(q) - 0.5, value_noise(q + Vec3{31, 0, 0}) - 0.5,
                    value_noise(q + Vec3{0, 57, 0}) - 0.5};
    const Vec3 n = normalized(point.normal + dent * 0.7);
    const double towards = dot(n, light.key);
    Vec3 colour = mix({0.36, 0.19, 0.01}, {0.88, 0.61, 0.08}, smooth_step(-0.8, 0.55, n.y + 0.4 * towards));
    colour = mix(colour, {0.30, 0.15, 0.01}, 0.8 * bell(n.y, -0.42, 0.2) + 0.35 * bell(n.y, 0.14, 0.07));
    colour = mix(colour, {1.0, 0.95, 0.62}, 0.95 * bell(towards, 0.93, 0.16) + 0.3 * bell(n.y, 0.38, 0.1));
    return colour;
}

/// Gold's reflections in another metal's tones.
Vec3 metal(const Material& material, const Light& light, const SurfacePoint& point) {
    const Vec3 colour = gold(material, light, point);
    if (material.texture == Material::Texture::Gold) return colour;
    const double bright = std::clamp((colour.x - 0.3) / 0.7, 0.0, 1.0);
    if (material.texture == Material::Texture::Silver) return mix({0.12, 0.13, 0.16}, {0.97, 0.98, 1.0}, std::pow(bright, 1.35));
    return mix({0.14, 0.06, 0.03}, {0.93, 0.62, 0.40}, std::pow(bright, 1.3));
}

bool is_metal(Material::Texture texture) {
    return texture == Material::Texture::Gold || texture == Material::Texture::Silver || texture == Material::Texture::Bronze;
}

}  // namespace

Vec3 mix(const Vec3& a, const Vec3& b, double t) { return a * (1 - t) + b * t; }

double smooth_step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

double value_noise(const Vec3& p) {
    const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const auto x = static_cast<std::int64_t>(fx), y = static_cast<std::int64_t>(fy),
               z = static_cast<std::int64_t>(fz);
    const double a = smooth_step(0, 1, p.x - fx), b = smooth_step(0, 1, p.y - fy),
                 c = smooth_step(0, 1, p.z - fz);
    const auto edge = [&](std::int64_t j, std::int64_t k) {
        return lattice(x, y + j, z + k) * (1 - a) + lattice(x + 1, y + j, z + k) * a;
    };
    const double low = edge(0, 0) * (1 - b) + edge(1, 0) * b;
    const double high = edge(0, 1) * (1 - b) + edge(1, 1) * b;
    return low * (1 - c) + high * c;
}

double layered_noise(const Vec3& p) {
    return (4 * value_noise(p) + 2 * value_noise(p * 2.03 + Vec3{17, 5, 3}) +
            value_noise(p * 4.01 + Vec3{3, 41, 7})) /
           7;
}

Material make_material(const std::string& word, Random random) {
    Material material;
    material.offset = {random.uniform(0, 50), random.uniform(0, 50), random.uniform(0, 50)};
    const Vec3 tint{random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03)};
    if (word == "wooden") {
        material.texture = Material::Texture::Wood;
        return material;
    }
    if (word == "stone") {
        material.texture = Material::Texture::Stone;
        return material;
    }
    if (word == "golden") {
        material.texture = Material::Texture::Gold;
        return material;
    }
    if (make_more_material(word, random, material)) {
        if (material.texture == Material::Texture::Plain) material.base = clamp01(material.base + tint);
        return material;
    }
    const auto found = std::find_if(PlainColours.begin(), PlainColours.end(),
                                    [&](const PlainColour& plain) { return word == plain.word; });
    GSE_CHECK(found != PlainColours.end());
    material.base = clamp01(found->colour + tint);
    return material;
}

Light make_light(Random random) {
    Light light;
    const double azimuth = random.uniform(-1.2, 1.2);  // from the front (-z)
    const double elevation = random.uniform(0.75, 1.15);
    light.key = {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                 -std::cos(azimuth) * std::cos(elevation)};
    light.key_strength = random.uniform(0.42, 0.55);
    light.sky_strength = random.uniform(0.55, 0.65);
    return light;
}

Vec3 shade(const Paint& paint, const Material& material, const Light& light, const SurfacePoint& point) {
    if (paint.slot == Slot::Glow) return paint.colour;
    const bool plain = material.texture == Material::Texture::Plain;
    const bool own = paint.slot == Slot::Fixed || (paint.slot == Slot::Trim && plain);
    const bool polished = !own && is_metal(material.texture);
    Vec3 colour = paint.colour;
    if (!own) {
        switch (material.texture) {
            case Material::Texture::Plain:
                colour = material.base;
                break;
            case Material::Texture::Wood:
                colour = wood(material, point.position);
                break;
            case Material::Texture::Stone:
                colour = stone(material, point.position);
                break;
            case Material::Texture::Gold:
            case Material::Texture::Silver:
            case Material::Texture::Bronze:
                colour = metal(material, light, point);
                break;
            default:
                colour = pattern_colour(material, point.position);
        }
        const double brightness = (colour.x + colour.y + colour.z) / 3;
        if (paint.slot == Slot::Pale)
            colour = brightness > 0.9 ? colour * 0.72
                                      : mix(colour, {1, 1, 1},
                                            plain   ? 0.5
                                            : polished ? 0.08
                                                    : 0.25);
        if (paint.slot == Slot::Deep)
            colour = brightness < 0.12 ? mix(colour, {1, 1, 1}, 0.25) : colour * 0.58;
    }
    const double sky = light.sky_strength * (0.86 + 0.14 * point.normal.y);
    const double key = light.key_strength * std::max(0.0, dot(point.normal, light.key));
    const double fill = 0.12 * std::max(0.0, -dot(point.normal, Vec3{light.key.x, 0, light.key.z}));
    const double near_ground = 0.72 + 0.28 * smooth_step(-0.05, 0.18, point.position.y);
    const double lit = (sky + key + fill) * near_ground;
    colour = colour * (polished ? 0.45 + 0.55 * lit : lit);
    if (!polished) {
        const double gloss = plain || own ? 0.22 : 0.05;
        colour = colour + Vec3{1, 1, 1} * (gloss * bell(dot(point.normal, light.key), 1.0, 0.09));
    }
    return clamp01(colour);
}

}  // namespace gse::synth
