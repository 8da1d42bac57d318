// Names that only one family of denoisers has, as their authors publish them, and sizes that tell variants
// apart.
#include "engine/neural/api/files/denoiser_kind.h"

#include <array>
#include <utility>

namespace gse::neural {
namespace {

// In order: a model's own names, those of checkpoints and of programs that wrap it.
constexpr std::array<std::string_view, 7> Prefixes{
    "model.diffusion_model.", "diffusion_model.", "net.", "model.", "transformer.", "unet.", ""};

struct FamilyMark {
    std::string_view tensor, family;
};
// The first that is there counts.
constexpr std::array<FamilyMark, 24> TransformerMarks{{
    {"joint_blocks.0.context_block.attn.qkv.weight", "Stable Diffusion 3"},
    {"clf.1.weight", "Stable Cascade"},
    {"double_layers.0.attn.w1q.weight", "AuraFlow"},
    {"mlp_t5.0.weight", "Hunyuan-DiT"},
    {"txt_in.individual_token_refiner.blocks.0.norm1.weight", "Hunyuan Video"},
    {"double_stream_modulation_img.lin.weight", "FLUX.2"},
    {"double_stream_modulation_img.linear.weight", "FLUX.2"},
    {"single_transformer_blocks.0.attn.to_qkv_mlp_proj.weight", "FLUX.2"},
    {"distilled_guidance_layer.0.norms.0.scale", "Chroma"},
    {"distilled_guidance_layer.norms.0.scale", "Chroma"},
    {"distilled_guidance_layer.norms.0.weight", "Chroma"},
    {"double_blocks.0.img_attn.norm.key_norm.scale", "FLUX.1"},
    {"double_blocks.0.img_attn.norm.key_norm.weight", "FLUX.1"},
    {"single_transformer_blocks.0.attn.norm_k.weight", "FLUX.1"},
    {"t5_yproj.weight", "Mochi"},
    {"pos_embed.proj.bias", "PixArt"},
    {"adaln_single.emb.timestep_embedder.linear_1.bias", "LTX Video"},
    {"t_block.1.weight", "PixArt"},
    {"head.modulation", "Wan"},
    {"patch_embedding.weight", "Wan"},
    {"caption_projection.0.linear.weight", "HiDream"},
    {"txt_norm.weight", "Qwen-Image"},
    {"blocks.block0.blocks.0.block.attn.to_q.0.weight", "Cosmos"},
    {"blocks.0.mlp.layer1.weight", "Cosmos"},
}};

/// Stable Diffusion by the width of the text that it is told.
std::string family_of_width(std::uint64_t width) {
    switch (width) {
        case 768: return "Stable Diffusion 1.x";
        case 1024: return "Stable Diffusion 2.x";
        case 2048: return "SDXL";
        case 1280: return "SDXL refiner";
        default: return "Stable Diffusion of an unknown width";
    }
}

std::string variant_of_channels(std::uint64_t channels) {
    switch (channels) {
        case 5: return "depth-to-image";
        case 7: return "upscaler";
        case 8: return "InstructPix2Pix";
        case 9: return "inpainting";
        default: return {};
    }
}

/// UNets, in the names of ldm and of diffusers.
WeightKind unet_kind(const TensorNames& names) {
    WeightKind kind;
    for (const auto& [first, blocks] : {std::pair{"input_blocks.0.0.weight", "input_blocks."},
                                        std::pair{"conv_in.weight", "down_blocks."}}) {
        if (!names.has(first)) continue;
        const auto* text = names.first(blocks, ".attn2.to_k.weight");
        if (text == nullptr || text->shape.size() < 2) continue;
        kind.family = family_of_width(text->shape[1]);
        kind.variant = variant_of_channels(names.size(first, 1));
    }
    return kind;
}

/// Variants of FLUX.1 by what the transformer takes beside the picture.
std::string flux_variant(const TensorNames& names) {
    const auto channels = names.size("img_in.weight", 1) + names.size("x_embedder.weight", 1);
    constexpr std::uint64_t Fill = 384, Control = 128;
    if (channels == Fill) return "Fill";
    if (channels == Control) return "Control";
    const bool guided = names.begins("guidance_in.") || names.begins("time_text_embed.guidance_embedder.");
    return guided ? "" : "schnell";
}

WeightKind transformer_kind(const TensorNames& names) {
    WeightKind kind;
    if (names.has("cap_embedder.1.weight") && names.begins("noise_refiner.0.")) {
        constexpr std::uint64_t ZImageWidth = 3840;
        kind.family = names.size("cap_embedder.1.weight", 0) == ZImageWidth ? "Z-Image" : "Lumina 2";
        return kind;
    }
    for (const auto& [tensor, family] : TransformerMarks) {
        if (!names.has(tensor)) continue;
        // Convolutions of the same name belong to encoders of pictures.
        if (tensor == "patch_embedding.weight" && !names.begins("blocks.0.cross_attn.")) continue;
        if (tensor == "pos_embed.proj.bias" && names.begins("transformer_blocks.0.attn.add_q_proj."))
            kind.family = "Stable Diffusion 3";
        else kind.family = family;
        if (family == "FLUX.1") kind.variant = flux_variant(names);
        return kind;
    }
    return kind;
}

}  // namespace

WeightKind denoiser_kind(const WeightHeader& header) {
    for (const auto prefix : Prefixes) {
        const TensorNames names(header, prefix);
        auto kind = unet_kind(names);
        if (kind.family.empty()) kind = transformer_kind(names);
        if (kind.family.empty()) continue;
        const TensorNames all(header, "");
        const bool text = all.begins("cond_stage_model.") || all.begins("conditioner.embedders.") ||
                          all.begins("text_encoders.");
        kind.role = text ? WeightRole::Checkpoint : WeightRole::DiffusionModel;
        return kind;
    }
    return {};
}

}  // namespace gse::neural
