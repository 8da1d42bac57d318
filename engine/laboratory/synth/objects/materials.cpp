// Procedural materials and the baked light model.
#include "engine/laboratory/synth/objects/materials.h"

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
    if (material.texture == Material::Texture::Silver)
        return mix({0.12, 0.13, 0.16}, {0.97, 0.98, 1.0}, std::pow(bright, 1.35));
    return mix({0.14, 0.06, 0.03}, {0.93, 0.62, 0.40}, std::pow(bright, 1.3));
}

bool is_metal(Material::Texture texture) {
    return texture == Material::Texture::Gold || texture == Material::Texture::Silver ||
           texture == Material::Texture::Bronze;
}

}  // namespace

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
            case Material::Texture::Plain: colour = material.base; break;
            case Material::Texture::Wood: colour = wood(material, point.position); break;
            case Material::Texture::Stone: colour = stone(material, point.position); break;
            case Material::Texture::Gold:
            case Material::Texture::Silver:
            case Material::Texture::Bronze: colour = metal(material, light, point); break;
            case Material::Texture::Pattern: colour = colour_at(material.pattern, point.position); break;
        }
        const double brightness = (colour.x + colour.y + colour.z) / 3;
        if (paint.slot == Slot::Pale)
            colour = brightness > 0.9 ? colour * 0.72
                                      : mix(colour, {1, 1, 1},
                                            plain      ? 0.5
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
