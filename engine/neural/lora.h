// Low-rank changes of weights (LoRA, Hu et al. 2021) and the files they travel in (kohya's names).
#pragma once

#include <torch/torch.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/neural/layers.h"

namespace gse::neural {

/// W + alpha / r * up down, for one layer.
struct LoraFactor {
    std::string layer;   // its name with "_" for "."; "down_blocks_0_attentions_0_..._attn1_to_q"
    torch::Tensor down;  // [r,in], or [r,in,k,k] for a convolution
    torch::Tensor up;    // [out,r], or [out,r,1,1]
    double alpha = 1;

    std::int64_t rank() const { return down.size(0); }
    double scale() const { return alpha / static_cast<double>(rank()); }
    /// alpha / r * up down, shaped like the weight.
    torch::Tensor change_of(const torch::Tensor& weight) const;
};

/// All changes of one model.
struct LoraWeights {
    std::vector<LoraFactor> unet, text;
};

/// A layer of a network that a LoRA changes.
struct LoraTarget {
    std::string layer;
    Linear linear{nullptr};
};

/// The attention projections: to_q, to_k, to_v, to_out.0 of the UNet; q_proj, k_proj, v_proj, out_proj of the text encoder.
std::vector<LoraTarget> lora_targets(const torch::nn::Module& network);

/// Factors for these layers: `down` drawn from `seed`, `up` zero, so nothing changes yet; alpha = rank.
std::vector<LoraFactor> new_lora(const std::vector<LoraTarget>& targets, std::int64_t rank, std::uint64_t seed);

/// Adds the changes, `strength` times, to the network's weights (given new memory: no other network sees it). Throws Error
/// (Model) when a layer is not there or has another shape.
void merge_lora(torch::nn::Module& network, const std::vector<LoraFactor>& factors, double strength);

/// lora_unet_<layer>.lora_down.weight, .lora_up.weight, .alpha; lora_te_<layer> for the text encoder.
void write_lora(const std::filesystem::path& path, const LoraWeights& weights);
/// Throws Error (NotFound, Malformed, Model).
LoraWeights read_lora(const std::filesystem::path& path);

}  // namespace gse::neural
