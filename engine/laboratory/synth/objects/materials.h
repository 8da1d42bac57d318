// Colours of the synthetic world: materials with procedural texture, and light that is baked into the colour.
#pragma once

#include <cstdint>
#include <string>

#include "engine/laboratory/synth/objects/shapes.h"
#include "engine/math/noise.h"
#include "engine/scene/surface_pattern.h"

namespace gse::synth {

/// A material as one scene shows it (`offset` moves the texture, `tint` varies a plain colour a little).
struct Material {
    enum class Texture : std::uint8_t { Plain, Wood, Stone, Gold, Silver, Bronze, Pattern };
    Texture texture = Texture::Plain;
    Vec3 base{};
    SurfacePattern pattern{};
    Vec3 offset{};
};

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

}  // namespace gse::synth
