// Low-rank changes of weights (LoRA, Hu et al. 2021; LoCon for convolutions) and the files they travel in.
#pragma once

#include <torch/torch.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/neural/layers/layers.h"

namespace gse::neural {

/// W + alpha / r * up down, for one layer; with a middle, up mid down.
struct LoraFactor {
    std::string layer;   // its name with "_" for "."; "down_blocks_0_attentions_0_..._attn1_to_q"
    torch::Tensor down;  // [r,in], or [r,in,k,k] for a convolution ([r,in,1,1] with a middle)
    torch::Tensor up;    // [out,r], or [out,r,1,1]
    double alpha = 1;
    torch::Tensor mid = {};  // [r,r,k,k] of a convolution in Tucker form (LyCORIS), else undefined
    std::string key = {};    // the beginning of its tensors' names in the file it was read from

    std::int64_t rank() const { return down.size(0); }
    double scale() const { return alpha / static_cast<double>(rank()); }
    /// alpha / r * up (mid) down, shaped like the weight, fp32.
    torch::Tensor change_of(const torch::Tensor& weight) const;
};

/// Tensors or layers of a LoRA's file that are not used.
struct LoraLeftOut {
    std::string noun, what;  // "tensor", "of norm layers"
    std::string first;       // the first one's name in the file
    std::size_t count = 0;
};

/// All changes of one model.
struct LoraWeights {
    std::vector<LoraFactor> unet, text;
    std::filesystem::path path = {};  // the file they were read from
    std::vector<LoraLeftOut> left_out = {};
    std::string note = {};  // sentence about a statement that is not used (StatedAlphas); empty = none

    /// Sentences about everything that the file holds and that is not used.
    std::vector<std::string> notes() const;
};

/// A layer of a network that a LoRA changes.
struct LoraTarget {
    std::string layer;
    Linear linear{nullptr};
};

/// The attention projections: to_q, to_k, to_v, to_out.0 of the UNet; q_proj, k_proj, v_proj, out_proj of the
/// text encoder.
std::vector<LoraTarget> lora_targets(const torch::nn::Module& network);

/// Factors for these layers: `down` drawn from `seed`, `up` zero, so nothing changes yet; alpha = rank.
std::vector<LoraFactor> new_lora(const std::vector<LoraTarget>& targets, std::int64_t rank,
                                 std::uint64_t seed);

/// Throws Error (Model) when a layer to change is missing in the network or has another shape. The network
/// may be on torch::kMeta. `path` is the file of the changes.
void check_lora(const torch::nn::Module& network, const std::vector<LoraFactor>& factors,
                const std::filesystem::path& path = {});

/// Leaves the layers out that the networks do not have. Throws Error (Model) as check_lora() for a layer of
/// another shape, and where no layer is left. The networks may be on torch::kMeta.
void fit_lora(LoraWeights& weights, const torch::nn::Module& unet, const torch::nn::Module& text);

/// Adds the changes, `strength` times, to the network's weights (given new memory: no other network sees it),
/// in fp32 whatever the weights' type. Throws as check_lora() does, before anything is changed.
void merge_lora(torch::nn::Module& network, const std::vector<LoraFactor>& factors, double strength);

/// lora_unet_<layer>.lora_down.weight, .lora_up.weight, .alpha; lora_te_<layer> for the text encoder.
void write_lora(const std::filesystem::path& path, const LoraWeights& weights);

/// Reads a LoRA. Names may be mixed:
/// kohya and LyCORIS (lora_unet_*, with a middle too), PEFT (unet.*.lora_A), diffusers before PEFT
/// (unet.*.processor.to_q_lora.down, unet.*.to_q.lora.down).
/// A missing alpha is what the file's metadata or the configuration beside it state (stated_alphas()), else
/// the rank. Tensors that change no weight of a layer are left out, as are layers of other adapters beside
/// those of LoRA. Throws Error (NotFound, Malformed, Unsupported, Model) that names file and tensor for other
/// kinds of adapters and for incomplete, misshapen or non-finite ones. Nothing is read then.
LoraWeights read_lora(const std::filesystem::path& path);

}  // namespace gse::neural
