// Reads LoRA files: the names that kohya, LyCORIS, PEFT and diffusers give to the same three matrices.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/neural/api/lora_alpha.h"
#include "engine/neural/weights/lora.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

enum class LoraRole { Down, Up, Mid, Alpha };

struct RoleEnding {
    std::string_view ending;
    LoraRole role;
    bool peft = false;
};
/// Endings of a module's name, longer ones before those they end in. "_lora" is diffusers' first way:
/// to_q_lora.down beside to_q.
constexpr std::array RoleEndings{
    RoleEnding{".lora_down.weight", LoraRole::Down},  // kohya, LyCORIS
    RoleEnding{".lora_up.weight", LoraRole::Up},
    RoleEnding{".lora_mid.weight", LoraRole::Mid},
    RoleEnding{".lora_A.weight", LoraRole::Down, true},  // PEFT
    RoleEnding{".lora_B.weight", LoraRole::Up, true},
    RoleEnding{".lora_A.default.weight", LoraRole::Down, true},
    RoleEnding{".lora_B.default.weight", LoraRole::Up, true},
    RoleEnding{".lora_linear_layer.down.weight", LoraRole::Down},  // diffusers 0.18 to 0.25
    RoleEnding{".lora_linear_layer.up.weight", LoraRole::Up},
    RoleEnding{".lora.down.weight", LoraRole::Down},
    RoleEnding{".lora.up.weight", LoraRole::Up},
    RoleEnding{"_lora.down.weight", LoraRole::Down},  // diffusers before
    RoleEnding{"_lora.up.weight", LoraRole::Up},
    RoleEnding{".alpha", LoraRole::Alpha},
};

/// Part of a tensor's name, and what it is of.
struct NameMark {
    std::string_view mark, name;
};
/// Adapters of other kinds. Their layers may stand beside those of LoRA.
constexpr std::array OtherAdapters{NameMark{".hada_", "LoHa"}, NameMark{".lokr_", "LoKr"},
                                   NameMark{".oft_", "OFT"}, NameMark{".on_input", "IA3"}};
/// They change how the matrices of the same layer count.
constexpr std::array Magnitudes{NameMark{".dora_scale", "DoRA"}, NameMark{".lora_magnitude_vector", "DoRA"}};
/// Tensors that stand beside a LoRA and are no part of it, special marks first.
constexpr std::array Companions{NameMark{"bundle_emb.", "of embeddings that are bundled with it"},
                                NameMark{".w_norm", "of norm layers"},
                                NameMark{".b_norm", "of norm layers"},
                                NameMark{".bias", "of biases"},
                                NameMark{".diff_b", "of biases"},
                                NameMark{".diff", "of whole weights"},
                                NameMark{".hada_", "of LoHa, another kind of adapter"},
                                NameMark{".lokr_", "of LoKr, another kind of adapter"},
                                NameMark{".oft_", "of OFT, another kind of adapter"},
                                NameMark{".on_input", "of IA3, another kind of adapter"}};
constexpr std::string_view UnknownTensor = "whose names are not known";

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
    std::string key;   // "lora_unet_..._to_q", "unet.down_blocks.0...to_q"
    std::string name;  // without what says which network it is of
    bool peft = false;
    torch::Tensor down, up, mid, alpha;
};

struct LoraKey {
    bool text = false;
    std::string layer, stem, name;
    LoraRole role = LoraRole::Down;
    bool peft = false;
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
    key.peft = ending->peft;
    key.stem = name.substr(0, name.size() - ending->ending.size());
    const bool first_way = ending->ending.front() == '_';
    constexpr std::array prefixes{std::pair{std::string_view("lora_unet_"), false},
                                  std::pair{std::string_view("lora_te_"), true},
                                  std::pair{std::string_view("unet."), false},
                                  std::pair{std::string_view("text_encoder."), true},
                                  std::pair{std::string_view("base_model.model.text_model."), true},
                                  std::pair{std::string_view("base_model.model."), false}};
    for (const auto& [prefix, text] : prefixes) {
        if (!key.stem.starts_with(prefix)) continue;
        const auto inner = prefix.ends_with("text_model.") ? prefix.find("text_model.") : prefix.size();
        key.text = text;
        key.name = key.stem.substr(inner);
        key.layer = layer_of(key.name, text, first_way);
        return true;
    }
    // The first files of diffusers hold the UNet's processors alone, under its own names.
    for (const char* block : {"down_blocks.", "mid_block.", "up_blocks."}) {
        if (!key.stem.starts_with(block)) continue;
        key.text = false;
        key.name = key.stem;
        key.layer = layer_of(key.stem, false, first_way);
        return true;
    }
    return false;
}

[[noreturn]] void refuse_lora(ErrorCode code, const std::string& what, const char* remedy,
                              const std::filesystem::path& path) {
    throw Error(code, what, remedy, path);
}

[[noreturn]] void refuse_adapter(const NameMark& kind, const std::string& name,
                                 const std::filesystem::path& path) {
    refuse_lora(
        ErrorCode::Unsupported,
        fmt::format("the file is a {} adapter (it has \"{}\"), which cannot be merged", kind.name, name),
        "use a LoRA or LoCon of the same, or merge it into a model with the program that made it", path);
}

void refuse_other_kinds(const SafetensorsFile& file) {
    const auto& path = file.path();
    if (file.entries().empty())
        refuse_lora(ErrorCode::Model, "the LoRA file holds no tensors", "download or write it again", path);
    for (const auto& [name, entry] : file.entries()) {
        for (const auto& other : Magnitudes)
            if (name.find(other.mark) != std::string::npos) refuse_adapter(other, name, path);
        for (const auto prefix : LargerModels)
            if (name.starts_with(prefix))
                refuse_lora(ErrorCode::Unsupported,
                            fmt::format("the LoRA was made for SDXL or a later model (it has \"{}\")", name),
                            "use one that was made for Stable Diffusion 1.x or 2.x", path);
    }
}

using LoraModules = std::map<std::pair<bool, std::string>, LoraModule>;  // by part and layer

/// Refuses a file in which there is no layer of LoRA.
[[noreturn]] void refuse_without_layers(const SafetensorsFile& file) {
    for (const auto& [name, entry] : file.entries())
        for (const auto& other : OtherAdapters)
            if (name.find(other.mark) != std::string::npos) refuse_adapter(other, name, file.path());
    refuse_lora(ErrorCode::Model,
                fmt::format("there is no LoRA in this file (it holds \"{}\")", file.entries().begin()->first),
                "a whole model is opened as the model; a LoRA is a file of lora_down and lora_up, or lora_A "
                "and lora_B",
                file.path());
}

void leave_out(const std::string& name, std::vector<LoraLeftOut>& left_out) {
    const auto mark = std::find_if(Companions.begin(), Companions.end(), [&](const auto& known) {
        return name.find(known.mark) != std::string::npos;
    });
    const std::string what(mark == Companions.end() ? UnknownTensor : mark->name);
    const auto known =
        std::find_if(left_out.begin(), left_out.end(), [&](const auto& part) { return part.what == what; });
    if (known != left_out.end()) ++known->count;
    else left_out.push_back({"tensor", what, name, 1});
}

LoraModules gather_modules(const SafetensorsFile& file, std::vector<LoraLeftOut>& left_out) {
    LoraModules modules;
    for (const auto& [name, entry] : file.entries()) {
        LoraKey key;
        if (!read_key(name, key)) {
            leave_out(name, left_out);
            continue;
        }
        auto& module = modules[{key.text, key.layer}];
        if (module.key.empty()) module.key = key.stem, module.name = key.name;
        module.peft |= key.peft;
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
    // An alpha alone belongs to a layer that another kind of adapter changes.
    std::erase_if(modules, [](const auto& item) {
        return !item.second.down.defined() && !item.second.up.defined() && !item.second.mid.defined();
    });
    if (modules.empty()) refuse_without_layers(file);
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

/// Factors with the alphas that are not among their tensors.
void take_stated_alphas(const SafetensorsFile& file, const LoraModules& modules, LoraWeights& weights) {
    std::vector<LoraLayer> layers;
    std::vector<LoraFactor*> factors;
    std::array<std::size_t, 2> next{};
    for (const auto& [place, module] : modules) {
        auto& list = place.first ? weights.text : weights.unet;
        auto& factor = list[next[place.first ? 1 : 0]++];
        if (module.alpha.defined()) continue;
        const bool kernel = module.mid.defined() || (factor.down.dim() == 4 && factor.down.size(2) > 1);
        layers.push_back({place.first, module.name, factor.rank(), module.peft, kernel});
        factors.push_back(&factor);
    }
    auto stated = stated_alphas(file.path(), file.metadata(), layers);
    for (std::size_t i = 0; i < factors.size(); ++i) factors[i]->alpha = stated.alphas[i];
    weights.note = std::move(stated.note);
}

}  // namespace

LoraWeights read_lora(const std::filesystem::path& path) {
    const SafetensorsFile file(path);
    refuse_other_kinds(file);
    require_memory(file.data_bytes(), fmt::format("the LoRA \"{}\"", path.filename().string()));
    LoraWeights weights;
    weights.path = path;
    const auto modules = gather_modules(file, weights.left_out);
    for (const auto& [place, module] : modules)
        (place.first ? weights.text : weights.unet).push_back(factor_of(place.second, module, path));
    take_stated_alphas(file, modules, weights);
    return weights;
}

}  // namespace gse::neural
