// The CLIP text encoder of Stable Diffusion (CLIPTextModel, CLIPTextModelWithProjection).
#pragma once

#include "engine/neural/api/config.h"
#include "engine/neural/layers/layers.h"

namespace gse::neural {

/// Output of the text encoder; [B,T,D] unless said otherwise.
struct TextEncoding {
    torch::Tensor last_hidden;                 // after the final norm: what the UNet is conditioned on
    std::vector<torch::Tensor> hidden_states;  // [0] embeddings, [i] output of layer i-1; no final norm
    torch::Tensor pooled;                      // [B,D] row of last_hidden at the end token
    torch::Tensor text_embeds;  // [B,P] projection of pooled; undefined without projection layer
};

/// One layer of CLIP's towers; an undefined mask lets every token see every other.
class ClipLayerImpl : public torch::nn::Module {
public:
    struct Shape {
        std::int64_t width = 0, inner = 0, heads = 1;
        std::string activation;
        double norm_eps = 1e-5;
    };
    ClipLayerImpl(const Shape& shape, const WeightOptions& options);
    torch::Tensor forward(torch::Tensor x, const torch::Tensor& mask) const;

private:
    std::int64_t heads_;
    bool quick_gelu_;
    Linear q_proj{nullptr}, k_proj{nullptr}, v_proj{nullptr}, out_proj{nullptr}, fc1{nullptr}, fc2{nullptr};
    LayerNorm layer_norm1{nullptr}, layer_norm2{nullptr};
};
TORCH_MODULE(ClipLayer);

class ClipTextEncoderImpl : public torch::nn::Module {
public:
    explicit ClipTextEncoderImpl(const TextEncoderConfig& config, const WeightOptions& options = {});

    /// ids [B,T] int64, T at most max_position_embeddings; attention_mask [B,T] (1 = keep) or undefined, as
    /// the Stable Diffusion pipelines have it.
    TextEncoding forward(const torch::Tensor& ids, const torch::Tensor& attention_mask = {}) const;
    /// Final layer norm of some hidden state ("clip skip").
    torch::Tensor final_norm(const torch::Tensor& hidden) const { return final_layer_norm->forward(hidden); }
    const TextEncoderConfig& config() const { return config_; }

private:
    TextEncoderConfig config_;
    Embedding token_embedding{nullptr}, position_embedding{nullptr};
    std::vector<ClipLayer> layers_;
    LayerNorm final_layer_norm{nullptr};
    Linear text_projection{nullptr};
};
TORCH_MODULE(ClipTextEncoder);

}  // namespace gse::neural
