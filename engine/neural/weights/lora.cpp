// Low-rank changes: making, checking, merging and writing them.
#include "engine/neural/weights/lora.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/neural/layers/parallel_for_batches.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

constexpr std::string_view LoraUNetPrefix = "lora_unet_", LoraTextPrefix = "lora_te_";
constexpr std::string_view LoraDown = ".lora_down.weight", LoraUp = ".lora_up.weight", LoraAlpha = ".alpha";
constexpr std::array<std::string_view, 8> TargetEndings{".to_q",   ".to_k",   ".to_v",   ".to_out.0",
                                                        ".q_proj", ".k_proj", ".v_proj", ".out_proj"};

std::string flat_name(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

torch::Tensor uniform(torch::IntArrayRef shape, double bound, Random& random) {
    auto tensor = torch::empty(shape, torch::kFloat32);
    float* values = tensor.data_ptr<float>();
    for (std::int64_t i = 0; i < tensor.numel(); ++i)
        values[i] = static_cast<float>(random.uniform(-bound, bound));
    return tensor;
}

using Shape = std::vector<std::int64_t>;

/// A matrix and a 1x1 convolution hold the same numbers.
Shape matrix_shape(const torch::Tensor& tensor) {
    Shape shape(tensor.sizes().begin(), tensor.sizes().end());
    if (shape.size() == 4 && shape[2] == 1 && shape[3] == 1) shape.resize(2);
    return shape;
}

bool fits(const LoraFactor& factor, const torch::Tensor& weight) {
    const auto rank = factor.rank();
    const Shape whole = matrix_shape(weight);
    Shape down = whole;
    down[0] = rank;
    if (factor.mid.defined()) {
        Shape mid = whole;
        if (mid.size() == 4) mid[0] = mid[1] = rank;
        if (mid.size() != 4 || matrix_shape(factor.mid) != mid) return false;
        down.resize(2);
    }
    return matrix_shape(factor.down) == down && matrix_shape(factor.up) == Shape{whole[0], rank};
}

/// Weights of the network by their layer's flat name; handles to them.
std::map<std::string, torch::Tensor> weights_by_layer(const torch::nn::Module& network) {
    std::map<std::string, torch::Tensor> weights;
    for (const auto& item : network.named_parameters()) {
        constexpr std::string_view ending = ".weight";
        const auto& name = item.key();
        if (name.ends_with(ending) && item.value().dim() >= 2)
            weights.emplace(flat_name(name.substr(0, name.size() - ending.size())), item.value());
    }
    return weights;
}

/// Adds the change to the weight, some rows at a time, so that intermediate values stay in the processor's
/// cache.
torch::Tensor changed_in_parts(const torch::Tensor& weight, const LoraFactor& factor, double strength) {
    constexpr std::int64_t numbers_at_once = 1 << 18;
    const auto up = factor.up.to(torch::kFloat32).flatten(1) * (factor.scale() * strength),
               down = factor.down.to(torch::kFloat32).flatten(1);
    const auto before = weight.flatten(1);
    auto changed = torch::empty_like(weight);
    auto after = changed.view({before.size(0), before.size(1)});
    const auto rows = std::max<std::int64_t>(1, numbers_at_once / before.size(1));
    for (std::int64_t first = 0; first < before.size(0); first += rows) {
        const auto count = std::min(rows, before.size(0) - first);
        auto part = before.narrow(0, first, count).to(torch::kFloat32, false, true);
        after.narrow(0, first, count).copy_(part.addmm_(up.narrow(0, first, count), down));
    }
    return changed;
}

std::string shape_text(const torch::Tensor& tensor) {
    return fmt::format("[{}]", fmt::join(tensor.sizes(), ","));
}

const std::string& name_of(const LoraFactor& factor) {
    return factor.key.empty() ? factor.layer : factor.key;
}

/// Factors of layers that are not there; the others have the right shape. Throws Error (Model).
std::vector<const LoraFactor*> unknown_layers(const torch::nn::Module& network,
                                              const std::vector<LoraFactor>& factors,
                                              const std::filesystem::path& path) {
    const auto weights = weights_by_layer(network);
    std::vector<const LoraFactor*> unknown;
    for (const auto& factor : factors) {
        const auto found = weights.find(factor.layer);
        if (found == weights.end()) {
            unknown.push_back(&factor);
        } else if (!fits(factor, found->second)) {
            throw Error(ErrorCode::Model,
                        fmt::format("the LoRA's change of \"{}\" has another shape: {} and {} do not make {}",
                                    name_of(factor), shape_text(factor.down), shape_text(factor.up),
                                    shape_text(found->second)),
                        "it was made for a model of another size: use it with the model it was made for",
                        path);
        }
    }
    return unknown;
}

[[noreturn]] void refuse_unknown(const std::string& first, std::size_t unknown, std::size_t all,
                                 const std::filesystem::path& path) {
    throw Error(
        ErrorCode::Model,
        fmt::format("the LoRA changes a layer the model does not have, \"{}\" ({} of {} are not there)",
                    first, unknown, all),
        "it was made for another kind of model: use it with the one it was made for", path);
}

}  // namespace

torch::Tensor LoraFactor::change_of(const torch::Tensor& weight) const {
    const auto left = up.to(torch::kFloat32).flatten(1), right = down.to(torch::kFloat32).flatten(1);
    if (!mid.defined()) return (left.mm(right) * scale()).view(weight.sizes());
    // out x rank, rank x rank x kernel, rank x in: one matrix product on either side of the middle.
    // [out,r,kk].
    const auto rows = left.mm(mid.to(torch::kFloat32).flatten(1)).view({left.size(0), mid.size(1), -1});
    return (rows.transpose(1, 2).matmul(right).transpose(1, 2) * scale())
        .reshape(weight.sizes());  // [out,in,kk]
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

std::vector<LoraFactor> new_lora(const std::vector<LoraTarget>& targets, std::int64_t rank,
                                 std::uint64_t seed) {
    std::vector<LoraFactor> factors;
    Random random(seed);
    for (const auto& target : targets) {
        const auto& weight = target.linear->weight;
        const auto in = weight.flatten(1).size(1);
        // Draws as the reference initialises a linear layer (Kaiming uniform with a = sqrt 5).
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

void check_lora(const torch::nn::Module& network, const std::vector<LoraFactor>& factors,
                const std::filesystem::path& path) {
    const auto unknown = unknown_layers(network, factors, path);
    if (!unknown.empty()) refuse_unknown(name_of(*unknown.front()), unknown.size(), factors.size(), path);
}

void fit_lora(LoraWeights& weights, const torch::nn::Module& unet, const torch::nn::Module& text) {
    const auto all = weights.unet.size() + weights.text.size();
    LoraLeftOut left_out{"layer", "that the model does not have", {}, 0};
    for (auto [network, factors] : {std::pair{&unet, &weights.unet}, std::pair{&text, &weights.text}}) {
        std::set<std::string> gone;
        for (const auto* factor : unknown_layers(*network, *factors, weights.path)) {
            if (left_out.count++ == 0) left_out.first = name_of(*factor);
            gone.insert(factor->layer);
        }
        std::erase_if(*factors, [&](const LoraFactor& factor) { return gone.contains(factor.layer); });
    }
    if (left_out.count == 0) return;
    if (left_out.count == all) refuse_unknown(left_out.first, left_out.count, all, weights.path);
    weights.left_out.push_back(std::move(left_out));
}

std::vector<std::string> LoraWeights::notes() const {
    std::vector<std::string> notes;
    if (!note.empty()) notes.push_back(note);
    std::vector<std::string> parts;
    for (const auto& part : left_out)
        parts.push_back(fmt::format("{} {}{} {} (\"{}\"{})", part.count, part.noun,
                                    part.count == 1 ? "" : "s", part.what, part.first,
                                    part.count == 1 ? "" : ", ..."));
    if (!parts.empty())
        notes.push_back(fmt::format("the LoRA \"{}\" is used without {}", path.filename().string(),
                                    fmt::join(parts, ", ")));
    return notes;
}

void merge_lora(torch::nn::Module& network, const std::vector<LoraFactor>& factors, double strength) {
    const torch::NoGradGuard no_grad;
    check_lora(network, factors);
    auto weights = weights_by_layer(network);
    const auto merge = [&](const LoraFactor& factor) {
        auto& weight = weights.at(factor.layer);
        auto here = factor;
        for (auto* part : {&here.down, &here.up, &here.mid})
            if (part->defined()) *part = part->to(weight.device());
        weight.set_data(
            here.mid.defined()
                ? (weight.to(torch::kFloat32) + here.change_of(weight) * strength).to(weight.scalar_type())
                : changed_in_parts(weight, here, strength));
    };
    std::set<std::string> layers;
    for (const auto& factor : factors) layers.insert(factor.layer);
    const bool apart =
        layers.size() == factors.size() && (weights.empty() || weights.begin()->second.device().is_cpu());
    // Layers are of all sizes: each takes every n-th.
    const std::int64_t threads = apart ? batch_threads() : 1;
    parallel_for_batches(threads, apart, [&](std::int64_t begin, std::int64_t end) {
        for (auto first = begin; first < end; ++first)
            for (auto i = static_cast<std::size_t>(first); i < factors.size();
                 i += static_cast<std::size_t>(threads))
                merge(factors[i]);
    });
}

void write_lora(const std::filesystem::path& path, const LoraWeights& weights) {
    NamedTensors tensors;
    const auto add = [&](std::string_view prefix, const std::vector<LoraFactor>& factors) {
        for (const auto& factor : factors) {
            const auto stem = std::string(prefix) + factor.layer;
            const auto plain = [](const torch::Tensor& t) {
                return t.detach().to(torch::kCPU, torch::kFloat32).contiguous();
            };
            tensors.emplace_back(stem + std::string(LoraAlpha),
                                 torch::tensor(static_cast<float>(factor.alpha)));
            tensors.emplace_back(stem + std::string(LoraDown), plain(factor.down));
            tensors.emplace_back(stem + std::string(LoraUp), plain(factor.up));
        }
    };
    add(LoraUNetPrefix, weights.unet);
    add(LoraTextPrefix, weights.text);
    std::map<std::string, std::string> metadata{{"ss_network_module", "networks.lora"}};
    if (!weights.unet.empty()) {
        metadata["ss_network_dim"] = std::to_string(weights.unet.front().rank());
        metadata["ss_network_alpha"] = fmt::format("{}", weights.unet.front().alpha);
    }
    write_safetensors(path, tensors, metadata);
}

}  // namespace gse::neural
