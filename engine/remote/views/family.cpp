// Table of families, and of the patterns of names that lead to them.
#include "engine/remote/views/family.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr auto Describes = PromptForm::Description, Instructs = PromptForm::Instruction;

// Settings: METHOD.md, Families of models.
constexpr std::array<ModelFamily, 18> Families{{
    {.name = "sd15", .strength = 0.85, .sampler = "Euler"},
    {.name = "sd15-inpainting", .inpaints = true, .strength = 1, .sampler = "Euler"},
    {.name = "ip2p", .form = Instructs, .distilled_guidance = 1.5, .strength = 1, .again_strength = 1},
    {.name = "sdxl", .steps = 24, .guidance_scale = 6, .strength = 0.8, .side = 1024, .sampler = "Euler"},
    {.name = "sdxl-distilled",
     .steps = 8,
     .guidance_scale = 1.5,
     .strength = 0.75,
     .side = 1024,
     .negative = false,
     .sampler = "Euler"},
    {.name = "sdxl-inpainting",
     .inpaints = true,
     .steps = 24,
     .guidance_scale = 6,
     .strength = 1,
     .side = 1024,
     .sampler = "Euler"},
    {.name = "flux1",
     .guidance_scale = 1,
     .distilled_guidance = 3.5,
     .strength = 0.9,
     .again_strength = 0.5,
     .side = 1024,
     .latent_cell = 16,
     .negative = false},
    {.name = "flux1-fill",
     .inpaints = true,
     .guidance_scale = 1,
     .distilled_guidance = 30,
     .strength = 1,
     .again_strength = 0.5,
     .side = 1024,
     .latent_cell = 16,
     .negative = false},
    {.name = "kontext",
     .form = Instructs,
     .guidance_scale = 1,
     .distilled_guidance = 2.5,
     .strength = 1,
     .again_strength = 1,
     .side = 1024,
     .latent_cell = 16,
     .negative = false,
     .whole_picture = true},
    {.name = "flux2",
     .form = Instructs,
     .guidance_scale = 1,
     .distilled_guidance = 3.5,
     .strength = 1,
     .again_strength = 1,
     .side = 1024,
     .latent_cell = 16,
     .negative = false,
     .references = 3,
     .picture_word = "image",
     .whole_picture = true},
    {.name = "flux2-klein",
     .form = Instructs,
     .steps = 4,
     .guidance_scale = 1,
     .strength = 1,
     .again_strength = 1,
     .side = 1024,
     .latent_cell = 16,
     .negative = false,
     .references = 3,
     .picture_word = "image",
     .whole_picture = true},
    {.name = "flux2-klein-base",
     .form = Instructs,
     .guidance_scale = 4.5,
     .strength = 1,
     .again_strength = 1,
     .side = 1024,
     .latent_cell = 16,
     .references = 3,
     .picture_word = "image",
     .whole_picture = true},
    {.name = "qwen-edit",
     .form = Instructs,
     .guidance_scale = 2.5,
     .strength = 1,
     .again_strength = 1,
     .side = 1008,
     .latent_cell = 16,
     .side_step = 112,
     .whole_picture = true},
    {.name = "qwen-edit-plus",
     .form = Instructs,
     .guidance_scale = 2.5,
     .strength = 1,
     .again_strength = 1,
     .side = 1008,
     .latent_cell = 16,
     .references = 2,
     .picture_word = "Picture",
     .side_step = 112,
     .whole_picture = true},
    {.name = "qwen-image",
     .guidance_scale = 2.5,
     .strength = 0.8,
     .side = 1008,
     .latent_cell = 16,
     .side_step = 112},
    {.name = "z-image",
     .steps = 9,
     .guidance_scale = 1,
     .strength = 0.8,
     .side = 1024,
     .latent_cell = 16,
     .negative = false},
    {.name = "z-image-base", .guidance_scale = 5, .strength = 0.8, .side = 1024, .latent_cell = 16},
    {.name = "editor",
     .form = Instructs,
     .guidance_scale = 1,
     .strength = 1,
     .again_strength = 1,
     .side = 1024,
     .latent_cell = 16,
     .negative = false,
     .references = 3,
     .picture_word = "image",
     .whole_picture = true},
}};

/// A name that holds these parts in this order, "*" between them, is of the family.
struct NamePattern {
    std::string_view pattern, family;
};

// The first that fits counts.
constexpr std::array<NamePattern, 35> Patterns{{{"kontext", "kontext"},
                                                {"klein*base", "flux2-klein-base"},
                                                {"klein", "flux2-klein"},
                                                {"flux.2", "flux2"},
                                                {"flux2", "flux2"},
                                                {"flux-2", "flux2"},
                                                {"flux_2", "flux2"},
                                                {"flux*fill", "flux1-fill"},
                                                {"qwen*edit*2509", "qwen-edit-plus"},
                                                {"qwen*edit*2511", "qwen-edit-plus"},
                                                {"qwen*edit*plus", "qwen-edit-plus"},
                                                {"qwen*edit", "qwen-edit"},
                                                {"qwen*image", "qwen-image"},
                                                {"z-image*base", "z-image-base"},
                                                {"z_image*base", "z-image-base"},
                                                {"zimage*base", "z-image-base"},
                                                {"z-image", "z-image"},
                                                {"z_image", "z-image"},
                                                {"zimage", "z-image"},
                                                {"flux", "flux1"},
                                                {"pix2pix", "ip2p"},
                                                {"ip2p", "ip2p"},
                                                {"xl*inpaint", "sdxl-inpainting"},
                                                {"inpaint*xl", "sdxl-inpainting"},
                                                {"xl*lightning", "sdxl-distilled"},
                                                {"xl*turbo", "sdxl-distilled"},
                                                {"xl*hyper", "sdxl-distilled"},
                                                {"hyper*xl", "sdxl-distilled"},
                                                {"xl*lcm", "sdxl-distilled"},
                                                {"xl", "sdxl"},
                                                {"pony", "sdxl"},
                                                {"illustrious", "sdxl"},
                                                {"noob", "sdxl"},
                                                {"inpaint", "sd15-inpainting"},
                                                {"gpt*image", "editor"}}};

/// True where the server itself holds what lies outside of a mask while a model redraws a whole picture.
bool keeps_outside(const ServerFacts& facts) {
    return facts.kind == ServerKind::SdCpp || facts.kind == ServerKind::Comfy || facts.product == "sd-server";
}

bool fits(std::string_view name, std::string_view pattern) {
    for (;;) {
        const auto star = pattern.find('*');
        const auto part = pattern.substr(0, star);
        const auto found = name.find(part);
        if (found == std::string_view::npos) return false;
        if (star == std::string_view::npos) return true;
        name.remove_prefix(found + part.size());
        pattern.remove_prefix(star + 1);
    }
}

}  // namespace

bool picture_is_reference(const ServerFacts& facts, const ModelFamily& family) {
    const bool by_references = facts.kind == ServerKind::SdCpp || facts.kind == ServerKind::Webui;
    return family.instructed() && by_references && facts.references > 0;
}

std::span<const ModelFamily> model_families() { return Families; }

const ModelFamily& family_of(std::string_view model, std::string_view otherwise) {
    std::string lower(model);
    for (auto& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    const auto found = std::find_if(Patterns.begin(), Patterns.end(),
                                    [&](const auto& pattern) { return fits(lower, pattern.pattern); });
    return family_named(found != Patterns.end() ? found->family : otherwise);
}

std::uint32_t server_seed(std::uint64_t seed) { return static_cast<std::uint32_t>(seed & 0x7fffffff); }

RedrawOrder order_of(const ModelFamily& family) {
    RedrawOrder order;
    order.steps = family.steps;
    order.guidance_scale = family.guidance_scale;
    order.distilled_guidance = family.distilled_guidance;
    order.strength = family.strength;
    order.sampler = family.sampler;
    order.side_step = family.side_step;
    return order;
}

void suit_to_server(RedrawOrder& order, const ServerFacts& facts, const ModelFamily& family) {
    if (!facts.takes_mask || (family.whole_picture && !keeps_outside(facts))) order.mask = {};
    if (picture_is_reference(facts, family)) order.references.insert(order.references.begin(), order.picture);
    if (order.references.size() > facts.references) order.references.resize(facts.references);
}

const ModelFamily& family_named(std::string_view name) {
    const auto found = std::find_if(Families.begin(), Families.end(),
                                    [&](const auto& family) { return family.name == name; });
    if (found != Families.end()) return *found;
    std::vector<std::string_view> names;
    for (const auto& family : Families) names.push_back(family.name);
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is no family of picture models", printable(std::string(name))),
                fmt::format("name one of {}", fmt::join(names, ", ")));
}

}  // namespace gse::remote
