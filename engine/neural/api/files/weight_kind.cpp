// Parts of models by names that only they have, and number types by how much of a file is in them.
#include "engine/neural/api/files/weight_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "engine/neural/api/files/denoiser_kind.h"
#include "engine/neural/api/files/lora_kind.h"
#include "engine/neural/api/files/tensor_names.h"

namespace gse::neural {
namespace {

struct RoleMark {
    std::string_view tensor;
    WeightRole role;
    std::string_view family;
};
// Names that begin so; the first that is there counts.
constexpr std::array<RoleMark, 19> Marks{{
    {"control_model.input_hint_block.", WeightRole::ControlNet, ""},
    {"input_hint_block.", WeightRole::ControlNet, ""},
    {"controlnet_cond_embedding.", WeightRole::ControlNet, ""},
    {"controlnet_blocks.", WeightRole::ControlNet, ""},
    {"controlnet_x_embedder.", WeightRole::ControlNet, ""},
    {"control_layers.", WeightRole::ControlNet, ""},
    {"lllite_unet_", WeightRole::ControlNet, "SDXL"},
    {"adapter.body.0.", WeightRole::ControlNet, "T2I adapter"},
    {"body.0.resnets.0.block1.", WeightRole::ControlNet, "T2I adapter"},
    {"ip_adapter.", WeightRole::IpAdapter, ""},
    {"image_proj.", WeightRole::IpAdapter, ""},
    {"redux_up.", WeightRole::IpAdapter, "FLUX Redux"},
    {"decoder.film_mul.", WeightRole::Segmenter, "CLIPSeg"},
    {"image_encoder.trunk.", WeightRole::Segmenter, "SAM 2"},
    {"vision_encoder.backbone.", WeightRole::Segmenter, "SAM 2"},
    {"mask_decoder.iou_token.", WeightRole::Segmenter, "SAM"},
    {"model.1.sub.0.RDB1.", WeightRole::Upscaler, "ESRGAN"},
    {"body.0.rdb1.", WeightRole::Upscaler, "ESRGAN"},
    {"layers.0.residual_group.", WeightRole::Upscaler, "SwinIR or alike"},
}};

WeightKind marked_kind(const WeightHeader& header) {
    const TensorNames names(header, "");
    for (const auto& mark : Marks)
        if (names.begins(mark.tensor)) return {mark.role, std::string(mark.family)};
    for (const char* embedding : {"emb_params", "clip_g", "clip_l"})
        if (names.has(embedding)) return {WeightRole::Embedding};
    return {};
}

/// A VAE by the channels of its latents.
WeightKind vae_kind(const WeightHeader& header) {
    for (const char* prefix : {"", "first_stage_model.", "vae."}) {
        const TensorNames names(header, prefix);
        if (names.has("decoder.middle.0.residual.0.gamma")) return {WeightRole::Vae, "Wan, Qwen-Image"};
        if (!names.has("decoder.conv_in.weight") || !names.begins("decoder.")) continue;
        if (names.dimensions("decoder.conv_in.weight") > 4) return {WeightRole::Vae, "Wan, Qwen-Image"};
        switch (names.size("decoder.conv_in.weight", 1)) {
            case 4: return {WeightRole::Vae, "Stable Diffusion"};
            case 16: return {WeightRole::Vae, "FLUX.1, SD 3, Z-Image"};
            case 32: return {WeightRole::Vae, "FLUX.2"};
            default: return {WeightRole::Vae};
        }
    }
    const TensorNames names(header, "");
    for (const char* first : {"decoder.layers.0.weight", "taesd_decoder.1.weight", "1.weight"}) {
        const bool tiny = names.dimensions(first) == 4 &&
                          (std::string_view(first) != "1.weight" || names.has("3.conv.0.weight"));
        if (!tiny) continue;
        const auto channels = names.size(first, 1);
        return {WeightRole::TinyVae, channels == 4    ? "Stable Diffusion"
                                     : channels == 16 ? "FLUX.1, SD 3"
                                                      : ""};
    }
    // An encoder of TAESD has the picture's channels first.
    if (names.dimensions("0.weight") == 4 && names.size("0.weight", 1) == 3 && names.has("1.conv.0.weight"))
        return {WeightRole::TinyVae, "Stable Diffusion"};
    return {};
}

std::string clip_name(std::uint64_t width) {
    switch (width) {
        case 768: return "CLIP-L";
        case 1024: return "CLIP-H";
        case 1280: return "CLIP-G";
        default: return "CLIP";
    }
}

std::string language_model_name(const TensorNames& names, const std::string& layer) {
    const auto width = names.size(layer + "self_attn.k_proj.weight", 1);
    if (names.has(layer + "post_feedforward_layernorm.weight")) return "Gemma";
    if (names.has(layer + "self_attn.k_proj.bias")) return width == 3584 ? "Qwen2.5-VL 7B" : "Qwen2.5";
    if (names.has(layer + "self_attn.q_norm.weight"))
        return width == 2560 ? "Qwen3 4B" : width == 4096 ? "Qwen3 8B" : "Qwen3";
    return width == 5120 ? "Mistral" : width == 4096 ? "Llama" : "language model";
}

WeightKind encoder_kind(const WeightHeader& header) {
    for (const char* prefix : {"", "transformer.", "model.", "text_encoder."}) {
        const TensorNames names(header, prefix);
        const char* clip = "text_model.encoder.layers.0.mlp.fc1.weight";
        if (names.has(clip)) return {WeightRole::TextEncoder, clip_name(names.size(clip, 1))};
        const char* t5 = "encoder.block.0.layer.0.SelfAttention.k.weight";
        if (names.has(t5)) {
            constexpr std::uint64_t UniversalVocabulary = 256384, LargestWidth = 4096;
            const std::string size = names.size(t5, 1) == LargestWidth ? "-XXL" : "";
            return {WeightRole::TextEncoder,
                    (names.size("shared.weight", 0) == UniversalVocabulary ? "UMT5" : "T5") + size};
        }
        for (const std::string layer : {"model.layers.0.", "layers.0.", "language_model.layers.0."})
            if (names.has(layer + "self_attn.k_proj.weight"))
                return {WeightRole::TextEncoder, language_model_name(names, layer)};
        if (names.has("vision_model.encoder.layers.0.mlp.fc1.weight"))
            return {WeightRole::ImageEncoder, "CLIP vision"};
        if (names.has("resblocks.0.attn.in_proj_weight")) return {WeightRole::TextEncoder, "OpenCLIP"};
    }
    return {};
}

/// Architectures that GGUF files state, where their tensors have other names.
WeightKind architecture_kind(const WeightHeader& header) {
    struct Stated {
        std::string_view name;
        WeightRole role;
        std::string_view family;
    };
    constexpr std::array<Stated, 18> Known{{{"flux", WeightRole::DiffusionModel, "FLUX.1"},
                                            {"flux2", WeightRole::DiffusionModel, "FLUX.2"},
                                            {"sd1", WeightRole::DiffusionModel, "Stable Diffusion 1.x"},
                                            {"sdxl", WeightRole::DiffusionModel, "SDXL"},
                                            {"sd3", WeightRole::DiffusionModel, "Stable Diffusion 3"},
                                            {"qwen_image", WeightRole::DiffusionModel, "Qwen-Image"},
                                            {"lumina2", WeightRole::DiffusionModel, "Z-Image or Lumina 2"},
                                            {"aura", WeightRole::DiffusionModel, "AuraFlow"},
                                            {"hidream", WeightRole::DiffusionModel, "HiDream"},
                                            {"wan", WeightRole::DiffusionModel, "Wan"},
                                            {"ltxv", WeightRole::DiffusionModel, "LTX Video"},
                                            {"hyvid", WeightRole::DiffusionModel, "Hunyuan Video"},
                                            {"cosmos", WeightRole::DiffusionModel, "Cosmos"},
                                            {"t5", WeightRole::TextEncoder, "T5"},
                                            {"t5encoder", WeightRole::TextEncoder, "T5"},
                                            {"qwen2vl", WeightRole::TextEncoder, "Qwen2.5-VL"},
                                            {"qwen3", WeightRole::TextEncoder, "Qwen3"},
                                            {"llama", WeightRole::TextEncoder, "Llama or Mistral"}}};
    const auto stated = header.metadata.find("general.architecture");
    if (stated == header.metadata.end()) return {};
    for (const auto& each : Known)
        if (each.name == stated->second) return {each.role, std::string(each.family)};
    return {WeightRole::Unknown, stated->second};
}

std::string type_name(const std::string& type) {
    if (type == "F16") return "fp16";
    if (type == "BF16") return "bf16";
    if (type == "F32") return "fp32";
    if (type == "F64") return "fp64";
    if (type.starts_with("F8")) return "fp8";
    if (type.starts_with("F4")) return "fp4";
    std::string lower(type);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return lower;
}

double elements(const HeaderTensor& tensor) {
    double count = 1;
    for (const auto size : tensor.shape) count *= static_cast<double>(size);
    return count;
}

/// States the type that most numbers are in, and whether it can be read here.
void note_numbers(const WeightHeader& header, WeightKind& kind) {
    std::map<std::string, double> counts;
    bool small_floats = false, four_bits = false, scaled = false;
    for (const auto& [name, tensor] : header.tensors) {
        counts[tensor.type] += elements(tensor);
        scaled = scaled || name.ends_with("weight_scale");
        small_floats = small_floats || tensor.type.starts_with("F8");
        four_bits = four_bits || name.find("bitsandbytes__") != std::string::npos ||
                    name.ends_with(".qweight") || name.ends_with(".weight_scale_2");
    }
    const auto most = std::max_element(counts.begin(), counts.end(), [](const auto& one, const auto& other) {
        return one.second < other.second;
    });
    if (header.format == WeightFormat::Gguf) {
        kind.numbers = most == counts.end() ? "GGUF" : "GGUF " + most->first;
        kind.readable = false;
        return;
    }
    if (most == counts.end()) return;
    kind.numbers = four_bits ? "4 bits" : small_floats ? "fp8" : type_name(most->first);
    const bool floats =
        most->first == "F16" || most->first == "BF16" || most->first == "F32" || most->first == "F64";
    const bool own_integers = most->first == "I8" && scaled;  // as this program quantizes
    kind.readable = (floats || own_integers) && !four_bits && !small_floats;
}

WeightKind role_and_family(const WeightHeader& header) {
    for (const auto read : {lora_kind, marked_kind, denoiser_kind, vae_kind, encoder_kind, architecture_kind})
        if (const auto kind = read(header); kind.role != WeightRole::Unknown) return kind;
    return architecture_kind(header);
}

}  // namespace

const char* role_name(WeightRole role) {
    switch (role) {
        case WeightRole::Checkpoint: return "checkpoint";
        case WeightRole::DiffusionModel: return "diffusion model";
        case WeightRole::Lora: return "LoRA";
        case WeightRole::Vae: return "VAE";
        case WeightRole::TinyVae: return "tiny VAE";
        case WeightRole::TextEncoder: return "text encoder";
        case WeightRole::ImageEncoder: return "image encoder";
        case WeightRole::ControlNet: return "ControlNet";
        case WeightRole::IpAdapter: return "IP-Adapter";
        case WeightRole::Upscaler: return "upscaler";
        case WeightRole::Embedding: return "embedding";
        case WeightRole::Segmenter: return "segmenter";
        case WeightRole::Unknown: break;
    }
    return "unknown weights";
}

WeightKind weight_kind(const WeightHeader& header) {
    auto kind = role_and_family(header);
    note_numbers(header, kind);
    return kind;
}

std::string kind_text(const WeightKind& kind) {
    const bool whole = kind.role == WeightRole::Checkpoint || kind.role == WeightRole::DiffusionModel;
    const bool changes =
        kind.role == WeightRole::Lora || kind.role == WeightRole::Vae || kind.role == WeightRole::TinyVae;
    std::string text = role_name(kind.role);
    const auto model = kind.variant.empty() || kind.role == WeightRole::Lora
                           ? kind.family
                           : fmt::format("{} {}", kind.family, kind.variant);
    if (kind.role == WeightRole::Lora && !kind.variant.empty()) text = kind.variant;
    if (!model.empty())
        text = whole     ? fmt::format("{} {}", model, text)
               : changes ? fmt::format("{} of {}", text, model)
                         : fmt::format("{} {}", text, model);
    return kind.numbers.empty() ? text : fmt::format("{}, {}", text, kind.numbers);
}

}  // namespace gse::neural
