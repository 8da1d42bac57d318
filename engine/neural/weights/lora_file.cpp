// Reads LoRA files: the names that kohya, LyCORIS, PEFT and diffusers give to the same three matrices.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/neural/weights/lora.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

enum class LoraRole { Down, Up, Mid, Alpha };

struct RoleEnding {
    std::string_view ending;
    LoraRole role;
};
/// Endings of a module's name, longer ones before those they end in. "_lora" is diffusers' first way:
/// to_q_lora.down beside to_q.
constexpr std::array RoleEndings{
    RoleEnding{".lora_down.weight", LoraRole::Down},  // kohya, LyCORIS
    RoleEnding{".lora_up.weight", LoraRole::Up},
    RoleEnding{".lora_mid.weight", LoraRole::Mid},
    RoleEnding{".lora_A.weight", LoraRole::Down},  // PEFT
    RoleEnding{".lora_B.weight", LoraRole::Up},
    RoleEnding{".lora_A.default.weight", LoraRole::Down},
    RoleEnding{".lora_B.default.weight", LoraRole::Up},
    RoleEnding{".lora_linear_layer.down.weight", LoraRole::Down},  // diffusers 0.18 to 0.25
    RoleEnding{".lora_linear_layer.up.weight", LoraRole::Up},
    RoleEnding{".lora.down.weight", LoraRole::Down},
    RoleEnding{".lora.up.weight", LoraRole::Up},
    RoleEnding{"_lora.down.weight", LoraRole::Down},  // diffusers before
    RoleEnding{"_lora.up.weight", LoraRole::Up},
    RoleEnding{".alpha", LoraRole::Alpha},
};

struct OtherAdapter {
    std::string_view mark, name;
};
constexpr std::array OtherAdapters{
    OtherAdapter{".hada_", "LoHa"},      OtherAdapter{".lokr_", "LoKr"},
    OtherAdapter{".dora_scale", "DoRA"}, OtherAdapter{".lora_magnitude_vector", "DoRA"},
    OtherAdapter{".oft_", "OFT"},        OtherAdapter{".on_input", "IA3"}};

/// Names that only models with two text encoders, or without a UNet, have.
constexpr std::array LargerModels{std::string_view("lora_te1_"),
                                  std::string_view("lora_te2_"),
                                  std::string_view("lora_te3_"),
                                  std::string_view("lora_unet_input_blocks_"),
                                  std::string_view("lora_unet_output_blocks_"),
                                  std::string_view("lora_unet_middle_block_"),
                                  std::string_view("text_encoder_2."),
                                  std::string_view("lora_transformer_"),
                                  std::string_view("transformer.")};

/// One layer's tensors as the file has them.
struct LoraModule {
    std::string key;  // "lora_unet_..._to_q", "unet.down_blocks.0...to_q"
    torch::Tensor down, up, mid, alpha;
};

struct LoraKey {
    bool text = false;
    std::string layer, stem;
    LoraRole role = LoraRole::Down;
};

void replace_part(std::string& name, std::string_view from, std::string_view to) {
    const auto at = name.find(from);
    if (at != std::string::npos) name.replace(at, from.size(), to);
}

/// "down_blocks.0.attentions.0.transformer_blocks.0.attn1.processor.to_out" of an early file to the layer's
/// own name.
std::string layer_of(std::string name, bool text, bool first_way) {
    replace_part(name, ".processor.", ".");
    if (first_way && text)
        for (const auto& [from, to] : {std::pair{".to_q", ".q_proj"}, std::pair{".to_k", ".k_proj"},
                                       std::pair{".to_v", ".v_proj"}, std::pair{".to_out", ".out_proj"}})
            if (name.ends_with(from)) replace_part(name, from, to);
    if (first_way && !text && name.ends_with(".to_out")) name += ".0";
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

/// False for a name that no LoRA has.
bool read_key(const std::string& name, LoraKey& key) {
    const auto ending = std::find_if(RoleEndings.begin(), RoleEndings.end(),
                                     [&](const auto& known) { return name.ends_with(known.ending); });
    if (ending == RoleEndings.end()) return false;
    key.role = ending->role;
    key.stem = name.substr(0, name.size() - ending->ending.size());
    const bool first_way = ending->ending.front() == '_';
    constexpr std::array prefixes{
        std::pair{std::string_view("lora_unet_"), false}, std::pair{std::string_view("lora_te_"), true},
        std::pair{std::string_view("unet."), false}, std::pair{std::string_view("text_encoder."), true},
        std::pair{std::string_view("base_model.model."), false}};
    for (const auto& [prefix, text] : prefixes) {
        if (!key.stem.starts_with(prefix)) continue;
        key.text = text;
        key.layer = layer_of(key.stem.substr(prefix.size()), text, first_way);
        return true;
    }
    // The first files of diffusers hold the UNet's processors alone, under its own names.
    for (const char* block : {"down_blocks.", "mid_block.", "up_blocks."}) {
        if (!key.stem.starts_with(block)) continue;
        key.text = false;
        key.layer = layer_of(key.stem, false, first_way);
        return true;
    }
    return false;
}

[[noreturn]] void refuse_lora(ErrorCode code, const std::string& what, const char* remedy,
                              const std::filesystem::path& path) {
    throw Error(code, what, remedy, path);
}

void refuse_other_kinds(const SafetensorsFile& file) {
    const auto& path = file.path();
    if (file.entries().empty())
        refuse_lora(ErrorCode::Model, "the LoRA file holds no tensors", "download or write it again", path);
    for (const auto& [name, entry] : file.entries()) {
        for (const auto& other : OtherAdapters)
            if (name.find(other.mark) != std::string::npos)
                refuse_lora(
                    ErrorCode::Unsupported,
                    fmt::format("the file is a {} adapter (it has \"{}\"), which cannot be merged",
                                other.name, name),
                    "use a LoRA or LoCon of the same, or merge it into a model with the program that made it",
                    path);
        for (const auto prefix : LargerModels)
            if (name.starts_with(prefix))
                refuse_lora(ErrorCode::Unsupported,
                            fmt::format("the LoRA was made for SDXL or a later model (it has \"{}\")", name),
                            "use one that was made for Stable Diffusion 1.x or 2.x", path);
    }
}

using LoraModules = std::map<std::pair<bool, std::string>, LoraModule>;  // by part and layer

LoraModules gather_modules(const SafetensorsFile& file) {
    LoraModules modules;
    std::string unknown;
    for (const auto& [name, entry] : file.entries()) {
        LoraKey key;
        if (!read_key(name, key)) {
            if (unknown.empty()) unknown = name;
            continue;
        }
        auto& module = modules[{key.text, key.layer}];
        if (module.key.empty()) module.key = key.stem;
        auto& place = key.role == LoraRole::Down  ? module.down
                      : key.role == LoraRole::Up  ? module.up
                      : key.role == LoraRole::Mid ? module.mid
                                                  : module.alpha;
        if (place.defined())
            refuse_lora(
                ErrorCode::Model,
                fmt::format("the LoRA changes one layer twice, as \"{}\" and \"{}\"", module.key, key.stem),
                "download or write it again", file.path());
        place = file.tensor(name);
    }
    if (modules.empty())
        refuse_lora(ErrorCode::Model, fmt::format("there is no LoRA in this file (it holds \"{}\")", unknown),
                    "a whole model is opened as the model; a LoRA is a file of lora_down and lora_up, or "
                    "lora_A and lora_B",
                    file.path());
    if (!unknown.empty())
        refuse_lora(ErrorCode::Model,
                    fmt::format("the LoRA file has a tensor that is not known, \"{}\"", unknown),
                    "the names of kohya, LyCORIS (LoCon), PEFT and diffusers are read", file.path());
    return modules;
}

/// Completeness, number types, ranks and values of one layer.
LoraFactor factor_of(const std::string& layer, const LoraModule& module, const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& what) {
        refuse_lora(ErrorCode::Model, fmt::format("the LoRA's \"{}\" {}", module.key, what),
                    "download or write it again", path);
    };
    if (!module.down.defined())
        refuse(module.up.defined() ? "has an up matrix without a down matrix" : "has no matrices");
    if (!module.up.defined()) refuse("has a down matrix without an up matrix");
    for (const auto* tensor : {&module.down, &module.up, &module.mid}) {
        if (!tensor->defined()) continue;
        if (!tensor->is_floating_point()) refuse("holds whole numbers instead of weights");
        if (tensor->dim() < 2 || tensor->numel() == 0) refuse("is empty, or of rank 0");
        if (!torch::isfinite(tensor->to(torch::kFloat32)).all().item<bool>())
            refuse("holds values that are not finite");
    }
    LoraFactor factor{layer, module.down, module.up, 1, {}, module.key};
    factor.mid = module.mid;
    if (factor.up.size(1) != factor.rank())
        refuse(fmt::format("has a down matrix of rank {} and an up matrix of rank {}", factor.rank(),
                           factor.up.size(1)));
    factor.alpha = static_cast<double>(factor.rank());
    if (!module.alpha.defined()) return factor;
    if (module.alpha.numel() != 1)
        refuse(fmt::format("has an alpha of {} numbers instead of one", module.alpha.numel()));
    factor.alpha = module.alpha.to(torch::kFloat64).reshape({-1})[0].item<double>();
    if (!std::isfinite(factor.alpha)) refuse("has an alpha that is not finite");
    return factor;
}

}  // namespace

LoraWeights read_lora(const std::filesystem::path& path) {
    const SafetensorsFile file(path);
    refuse_other_kinds(file);
    require_memory(file.data_bytes(), fmt::format("the LoRA \"{}\"", path.filename().string()));
    LoraWeights weights;
    weights.path = path;
    for (const auto& [place, module] : gather_modules(file))
        (place.first ? weights.text : weights.unet).push_back(factor_of(place.second, module, path));
    return weights;
}

}  // namespace gse::neural
