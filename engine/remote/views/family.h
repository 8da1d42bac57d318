// Families of picture models: how each is driven, known by the model's name. One table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Sentence that a family learned from: what the picture shows, or what is to be done to it.
enum class PromptForm { Description, Instruction };

/// Settings that a family of models is used with.
struct ModelFamily {
    std::string_view name;
    PromptForm form = PromptForm::Description;
    bool inpaints = false;               // trained to fill masks
    int steps = 20;                      // that are really run
    double guidance_scale = 7;           // classifier-free guidance
    double distilled_guidance = 0;       // 0 = not sent
    double strength = 0.75;              // of the first round
    double again_strength = 0.4;         // of later rounds, which begin from the fitted scene
    int side = 512;                      // of the pictures, px
    int latent_cell = 8;                 // px of a picture per cell of the latent
    bool negative = true;                // takes a negative prompt
    std::size_t references = 0;          // pictures beside the one to redraw
    std::string_view picture_word = {};  // by which pictures are named in an instruction: "image 1"
    std::string_view sampler = {};       // empty = the server's choice
    int side_step = 64;                  // px: sides of its pictures are multiples
    // It was trained to redraw whole pictures. A mask counts only where the server keeps the rest.
    bool whole_picture = false;
    bool instructed() const { return form == PromptForm::Instruction; }
    /// True where a second round is drawn at a lower strength.
    bool has_strength() const { return again_strength < strength; }
};

/// All families.
std::span<const ModelFamily> model_families();

/// Family of a model by its name or file name; the one named `otherwise` where the name tells nothing.
const ModelFamily& family_of(std::string_view model, std::string_view otherwise = "sd15");

/// Seed as servers take it: 31 bits.
std::uint32_t server_seed(std::uint64_t seed);

/// Order with the settings of a family for a first round; it lacks pictures and prompts.
RedrawOrder order_of(const ModelFamily& family);

/// True where a server edits by pictures beside the one to redraw, and has to be sent that one, too.
bool picture_is_reference(const ServerFacts& facts, const ModelFamily& family);

/// Suits an order to what a server takes. Masks and references that it does not take are dropped. The picture
/// itself is among the references where its models edit by those.
void suit_to_server(RedrawOrder& order, const ServerFacts& facts, const ModelFamily& family);

/// Family of that name. Throws Error (InvalidArgument) that lists the names.
const ModelFamily& family_named(std::string_view name);

}  // namespace gse::remote
