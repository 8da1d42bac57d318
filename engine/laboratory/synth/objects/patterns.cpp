// More colours and materials: metals, and patterns of every surface.
#include <algorithm>
#include <array>

#include "engine/laboratory/synth/objects/materials.h"

namespace gse::synth {
namespace {

using Texture = Material::Texture;

struct NamedMaterial {
    const char* word;
    Texture texture;
    Vec3 base;
};

constexpr std::array<NamedMaterial, 6> MoreMaterials{{{"pink", Texture::Plain, {0.98, 0.45, 0.68}},
                                                      {"brown", Texture::Plain, {0.40, 0.20, 0.08}},
                                                      {"gray", Texture::Plain, {0.47, 0.47, 0.48}},
                                                      {"turquoise", Texture::Plain, {0.06, 0.76, 0.74}},
                                                      {"silver", Texture::Silver, {}},
                                                      {"bronze", Texture::Bronze, {}}}};

/// Strong colours of stripes and spots.
constexpr std::array<Vec3, 6> Strong{Vec3{0.82, 0.08, 0.08}, Vec3{0.10, 0.22, 0.85}, Vec3{0.05, 0.50, 0.18},
                                     Vec3{0.50, 0.12, 0.70}, Vec3{0.95, 0.45, 0.05}, Vec3{0.08, 0.08, 0.09}};

}  // namespace

bool make_more_material(const std::string& word, Random& random, Material& material) {
    if (const auto pattern = pattern_named(word)) {
        material.texture = Texture::Pattern;
        material.pattern = *pattern;
        material.pattern.offset = material.offset;
        if (takes_colours(pattern->kind) && pattern->kind != SurfacePattern::Kind::Checkered) {
            material.pattern.first = Strong[random.below(Strong.size())];
            if (pattern->kind == SurfacePattern::Kind::Spotted && random.uniform() < 0.5)
                std::swap(material.pattern.first, material.pattern.second);
        }
        return true;
    }
    const auto found = std::find_if(MoreMaterials.begin(), MoreMaterials.end(),
                                    [&](const NamedMaterial& named) { return word == named.word; });
    if (found == MoreMaterials.end()) return false;
    material.texture = found->texture;
    material.base = found->base;
    return true;
}

}  // namespace gse::synth
