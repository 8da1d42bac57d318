// Low-rank changes: making, merging, reading and writing them.
#include "engine/neural/lora.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/neural/safetensors.h"

namespace gse::neural {
namespace {

constexpr std::string_view UNetPrefix = "lora_unet_", TextPrefix = "lora_te_";
constexpr std::string_view Down = ".lora_down.weight", Up = ".lora_up.weight", Alpha = ".alpha";
constexpr std::array<std::string_view, 8> TargetEndings{".to_q",   ".to_k",   ".to_v",   ".to_out.0",
                                                        ".q_proj", ".k_proj", ".v_proj", ".out_proj"};

std::string flat_name(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

torch::Tensor uniform(torch::IntArrayRef shape, double bound, Random& random) {
    auto tensor = torch::empty(shape, torch::kFloat32);
    float* values = tensor.data_ptr<float>();
    for (std::int64_t i = 0; i < tensor.numel(); ++i) values[i] = static_cast<float>(random.uniform(-bound, bound));
    return tensor;
}

bool fits(const LoraFactor& factor, const torch::Tensor& weight) {
    if (factor.down.dim() < 2 || factor.up.dim() < 2 || factor.up.flatten(1).size(1) != factor.rank()) return false;
    return factor.up.size(0) == weight.size(0) && factor.down.numel() == factor.rank() * weight[0].numel();
}

/// The factors of one part of the file; complete triples (alpha may be missing: then it is the rank).
std::vector<LoraFactor> read_part(const SafetensorsFile& file, std::string_view prefix) {
    std::vector<LoraFactor> factors;
    for (const auto& [key, entry] : file.entries()) {
        if (!key.starts_with(prefix) || !key.ends_with(Down)) continue;
        const auto stem = key.substr(0, key.size() - Down.size());
        LoraFactor factor;
        factor.layer = stem.substr(prefix.size());
        factor.down = file.tensor(key).to(torch::kFloat32);
        factor.up = file.tensor(stem + std::string(Up)).to(torch::kFloat32);
        if (factor.down.dim() == 0 || factor.down.size(0) == 0)
            throw Error(ErrorCode::Model, fmt::format("the LoRA's tensor \"{}\" is empty", key), {}, file.path());
        const auto alpha = stem + std::string(Alpha);
        factor.alpha = file.contains(alpha) ? file.tensor(alpha).to(torch::kFloat64).reshape({-1})[0].item<double>()
                                            : static_cast<double>(factor.rank());
        factors.push_back(std::move(factor));
    }
    return factors;
}

bool is_lora_key(const std::string& key) {
    return (key.starts_with(UNetPrefix) || key.starts_with(TextPrefix)) &&
           (key.ends_with(Down) || key.ends_with(Up) || key.ends_with(Alpha));
}

}  // namespace

torch::Tensor LoraFactor::change_of(const torch::Tensor& weight) const {
    return (up.flatten(1).mm(down.flatten(1)) * scale()).view(weight.sizes());
}

std::vector<LoraTarget> lora_targets(const torch::nn::Module& network) {
    std::vector<LoraTarget> targets;
    for (const auto& item : network.named_modules()) {
        const auto linear = std::dynamic_pointer_cast<LinearImpl>(item.value());
        if (!linear) continue;
        if (std::any_of(TargetEndings.begin(), TargetEndings.end(),
                        [&](auto ending) { return item.key().ends_with(ending); }))
            targets.push_back({flat_name(item.key()), Linear(linear)});
    }
    return targets;
}

std::vector<LoraFactor> new_lora(const std::vector<LoraTarget>& targets, std::int64_t rank, std::uint64_t seed) {
    std::vector<LoraFactor> factors;
    Random random(seed);
    for (const auto& target : targets) {
        const auto& weight = target.linear->weight;
        const auto in = weight.flatten(1).size(1);
        // As the reference initialises a linear layer (Kaiming uniform with a = sqrt 5).
        const double bound = 1.0 / std::sqrt(static_cast<double>(in));
        LoraFactor factor;
        factor.layer = target.layer;
        factor.down = uniform({rank, in}, bound, random).to(weight.device());
        factor.up = torch::zeros({weight.size(0), rank}, factor.down.options());
        factor.alpha = static_cast<double>(rank);
        factors.push_back(std::move(factor));
    }
    return factors;
}

void merge_lora(torch::nn::Module& network, const std::vector<LoraFactor>& factors, double strength) {
    const torch::NoGradGuard no_grad;
    std::map<std::string, torch::Tensor> weights;
    for (auto& item : network.named_parameters()) {
        constexpr std::string_view ending = ".weight";
        const auto& name = item.key();
        if (name.ends_with(ending) && item.value().dim() >= 2)
            weights.emplace(flat_name(name.substr(0, name.size() - ending.size())), item.value());
    }
    for (const auto& factor : factors) {
        const auto found = weights.find(factor.layer);
        if (found == weights.end())
            throw Error(ErrorCode::Model, fmt::format("the LoRA changes a layer the model does not have, \"{}\"", factor.layer),
                        "it was made for another kind of model");
        auto& weight = found->second;
        if (!fits(factor, weight))
            throw Error(ErrorCode::Model, fmt::format("the LoRA's change of \"{}\" has another shape", factor.layer),
                        "it was made for a model of another size");
        const LoraFactor here{factor.layer, factor.down.to(weight.device()), factor.up.to(weight.device()), factor.alpha};
        weight.set_data(weight + here.change_of(weight) * strength);
    }
}

void write_lora(const std::filesystem::path& path, const LoraWeights& weights) {
    NamedTensors tensors;
    const auto add = [&](std::string_view prefix, const std::vector<LoraFactor>& factors) {
        for (const auto& factor : factors) {
            const auto stem = std::string(prefix) + factor.layer;
            const auto plain = [](const torch::Tensor& t) { return t.detach().to(torch::kCPU, torch::kFloat32).contiguous(); };
            tensors.emplace_back(stem + std::string(Alpha), torch::tensor(static_cast<float>(factor.alpha)));
            tensors.emplace_back(stem + std::string(Down), plain(factor.down));
            tensors.emplace_back(stem + std::string(Up), plain(factor.up));
        }
    };
    add(UNetPrefix, weights.unet);
    add(TextPrefix, weights.text);
    std::map<std::string, std::string> metadata{{"ss_network_module", "networks.lora"}};
    if (!weights.unet.empty()) {
        metadata["ss_network_dim"] = std::to_string(weights.unet.front().rank());
        metadata["ss_network_alpha"] = fmt::format("{}", weights.unet.front().alpha);
    }
    write_safetensors(path, tensors, metadata);
}

LoraWeights read_lora(const std::filesystem::path& path) {
    const SafetensorsFile file(path);
    for (const auto& [key, entry] : file.entries())
        if (!is_lora_key(key))
            throw Error(ErrorCode::Model, fmt::format("the LoRA file has a tensor that is not known, \"{}\"", key),
                        "only kohya's names (lora_unet_..., lora_te_...) are read", path);
    LoraWeights weights{read_part(file, UNetPrefix), read_part(file, TextPrefix)};
    if (weights.unet.empty() && weights.text.empty())
        throw Error(ErrorCode::Model, "there is no LoRA in this file", {}, path);
    return weights;
}

}  // namespace gse::neural
