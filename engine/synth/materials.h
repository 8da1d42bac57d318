// Colours of the synthetic world: materials with procedural texture, and light that is baked into the colour.
#pragma once

#include <cstdint>
#include <string>

#include "engine/synth/shapes.h"

namespace gse::synth {

/// Smooth noise in [0,1] with features of about one unit; the same everywhere for the same point.
double value_noise(const Vec3& p);
/// Three octaves of value_noise, in [0,1].
double layered_noise(const Vec3& p);

/// A material as one scene shows it (`offset` moves the texture, `tint` varies a plain colour a little).
struct Material {
    enum class Texture : std::uint8_t { Plain, Wood, Stone, Gold, Silver, Bronze, Marble, Brick, Striped, Spotted, Checkered, Rainbow, Rusty, Lava, Mossy };
    Texture texture = Texture::Plain;
    Vec3 base{};
    Vec3 second{};   // of stripes, spots and squares
    Vec3 offset{};
};

/// Colour of the textures of more_material_words() (not of metals) at a point of model space.
Vec3 pattern_colour(const Material& material, const Vec3& p);

/// Makes `material` one of more_material_words(); false for another word.
bool make_more_material(const std::string& word, Random& random, Material& material);

/// Material of a word of material_words() or more_material_words(); `random` varies tint and texture.
Material make_material(const std::string& word, Random random);

/// One directional key light, a weak opposite one, sky light. Model space (y up).
struct Light {
    Vec3 key{0, 1, 0};  // unit vector towards the light
    double key_strength = 0.5;
    double sky_strength = 0.6;
};

Light make_light(Random random);

/// Display colour in [0,1] of a surface point.
Vec3 shade(const Paint& paint, const Material& material, const Light& light, const SurfacePoint& point);

Vec3 mix(const Vec3& a, const Vec3& b, double t);
double smooth_step(double low, double high, double x);

}  // namespace gse::synth
