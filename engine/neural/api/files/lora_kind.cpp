// Layers of the model that a LoRA was made for, in the names of kohya, PEFT and diffusers, and the widths
// that tell models of one structure apart.
#include "engine/neural/api/files/lora_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace gse::neural {
namespace {

struct NameMark {
    std::string_view mark, name;
};
// Adapters that are no plain low-rank product.
constexpr std::array OtherAdapters{
    NameMark{".hada_w1", "LoHa"}, NameMark{".lokr_w", "LoKr"},     NameMark{".oft_", "OFT"},
    NameMark{".on_input", "IA3"}, NameMark{".dora_scale", "DoRA"}, NameMark{".lora_magnitude_vector", "DoRA"},
    NameMark{".glora_", "GLoRA"}};
constexpr std::array<std::string_view, 7> PlainMarks{
    ".lora_down.", ".lora_up.", ".lora_A.", ".lora_B.", ".lora.down.", "_lora.down.", ".lora_linear_layer."};

bool holds(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// Facts that are gathered over all tensors.
struct Layers {
    bool unet = false;
    bool top_level = false;  // attention at the full size
    bool text = false, second_text = false;
    bool flux = false, flux2 = false, joint = false, qwen = false, wan = false, refiner = false;
    std::uint64_t cross_width = 0;   // of the text that a UNet's attention is told
    std::uint64_t text_width = 0;    // of a CLIP text encoder
    std::uint64_t layers_width = 0;  // of "layers.N.attention"
};

/// A name in one way of writing for all trainers: "." becomes "_".
std::string flattened(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

bool is_down(const std::string& name) {
    return name.ends_with("lora_down_weight") || name.ends_with("lora_A_weight") ||
           name.ends_with("lora_A_default_weight") || name.ends_with("layer_down_weight");
}

void note_unet(const std::string& name, Layers& layers) {
    for (const char* block :
         {"down_blocks_", "up_blocks_", "mid_block_", "input_blocks_", "output_blocks_", "middle_block_"})
        layers.unet = layers.unet || holds(name, block);
    // SDXL has no attention at the full size.
    for (const char* block : {"down_blocks_0_attentions", "up_blocks_3_attentions", "input_blocks_1_1_",
                              "input_blocks_2_1_", "output_blocks_9_1_", "output_blocks_10_1_"})
        layers.top_level = layers.top_level || holds(name, block);
    layers.second_text = layers.second_text || holds(name, "lora_te2_") || holds(name, "text_encoder_2");
    layers.text = layers.text || name.starts_with("lora_te_") || name.starts_with("text_encoder_text_model");
}

void note_transformer(const std::string& name, const HeaderTensor& tensor, Layers& layers) {
    layers.flux = layers.flux || holds(name, "double_blocks_") || holds(name, "single_blocks_") ||
                  holds(name, "single_transformer_blocks_");
    layers.flux2 = layers.flux2 || holds(name, "to_qkv_mlp_proj") || holds(name, "double_stream_modulation");
    layers.joint = layers.joint || holds(name, "joint_blocks_");
    for (const char* part : {"_img_mlp_", "_txt_mlp_", "_img_mod_", "_txt_mod_"})
        layers.qwen = layers.qwen || (holds(name, part) && holds(name, "transformer_blocks_"));
    layers.wan = layers.wan || (holds(name, "blocks_0_cross_attn_") && !holds(name, "transformer_blocks_"));
    layers.refiner = layers.refiner || holds(name, "noise_refiner_") || holds(name, "context_refiner_");
    if (!is_down(name) || tensor.shape.size() < 2) return;
    const auto in = tensor.shape[1];
    if (holds(name, "attn2") && holds(name, "to_k")) layers.cross_width = in;
    if (holds(name, "self_attn_q_proj") && holds(name, "encoder_layers_")) layers.text_width = in;
    const bool attention = holds(name, "attention_to_q") || holds(name, "attention_qkv") ||
                           holds(name, "attention_to_k") || holds(name, "attention_to_v");
    if (attention && holds(name, "layers_")) layers.layers_width = in;
    // FLUX.2 comes in widths of its own, apart from the smallest.
    constexpr std::uint64_t Klein9 = 4096, Dev2 = 6144;
    const bool picture = holds(name, "img_attn_qkv") || holds(name, "single_blocks_0_linear1");
    if (picture && (in == Klein9 || in == Dev2)) layers.flux2 = true;
}

std::string family_of(const Layers& layers) {
    constexpr std::uint64_t First = 768, Second = 1024, Large = 2048, ZImage = 3840, Lumina = 2304;
    if (layers.flux) return layers.flux2 ? "FLUX.2" : "FLUX.1";
    if (layers.joint) return "Stable Diffusion 3";
    if (layers.qwen) return "Qwen-Image";
    if (layers.layers_width == ZImage) return "Z-Image";
    if (layers.layers_width == Lumina) return "Lumina 2";
    if (layers.refiner) return "Z-Image or Lumina 2";
    if (layers.unet) {
        if (layers.cross_width == First) return "Stable Diffusion 1.x";
        if (layers.cross_width == Second) return "Stable Diffusion 2.x";
        if (layers.cross_width == Large || layers.second_text || !layers.top_level) return "SDXL";
        return layers.text_width == Second ? "Stable Diffusion 2.x" : "Stable Diffusion 1.x";
    }
    if (layers.wan) return "Wan";
    if (layers.second_text) return "SDXL";
    if (layers.text) return layers.text_width == Second ? "Stable Diffusion 2.x" : "Stable Diffusion 1.x";
    return {};
}

/// Families as trainers state them, lower case.
std::string stated_family(const WeightHeader& header) {
    for (const char* key : {"modelspec.architecture", "ss_base_model_version"}) {
        const auto found = header.metadata.find(key);
        if (found == header.metadata.end()) continue;
        std::string text = found->second;
        std::transform(text.begin(), text.end(), text.begin(),
                       [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
        for (const auto& [mark, name] :
             {NameMark{"flux-2", "FLUX.2"}, NameMark{"flux2", "FLUX.2"}, NameMark{"flux_2", "FLUX.2"},
              NameMark{"klein", "FLUX.2"}, NameMark{"chroma", "Chroma"}, NameMark{"flux", "FLUX.1"},
              NameMark{"qwen", "Qwen-Image"}, NameMark{"z-image", "Z-Image"}, NameMark{"zimage", "Z-Image"},
              NameMark{"z_image", "Z-Image"}, NameMark{"hunyuan", "Hunyuan Video"}, NameMark{"wan", "Wan"},
              NameMark{"xl", "SDXL"}, NameMark{"v2", "Stable Diffusion 2.x"},
              NameMark{"v1", "Stable Diffusion 1.x"}})
            if (holds(text, mark)) return std::string(name);
    }
    return {};
}

}  // namespace

WeightKind lora_kind(const WeightHeader& header) {
    WeightKind kind;
    Layers layers;
    for (const auto& [name, tensor] : header.tensors) {
        const auto other = std::find_if(OtherAdapters.begin(), OtherAdapters.end(),
                                        [&](const NameMark& each) { return holds(name, each.mark); });
        const bool plain = std::any_of(PlainMarks.begin(), PlainMarks.end(),
                                       [&](std::string_view mark) { return holds(name, mark); });
        if (other != OtherAdapters.end()) kind.variant = other->name;
        if (other == OtherAdapters.end() && !plain) continue;
        kind.role = WeightRole::Lora;
        const auto flat = flattened(name);
        note_unet(flat, layers);
        note_transformer(flat, tensor, layers);
    }
    if (kind.role != WeightRole::Lora) return {};
    kind.family = family_of(layers);
    const auto stated = stated_family(header);
    // One structure, several models.
    const bool refined =
        kind.family == "FLUX.1" && (stated == "FLUX.2" || stated == "Chroma" || stated == "Hunyuan Video");
    if (kind.family.empty() || refined) kind.family = stated;
    return kind;
}

}  // namespace gse::neural
