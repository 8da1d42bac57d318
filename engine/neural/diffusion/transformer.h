// The UNet's spatial transformer: self-attention, cross-attention with capture, gated feed-forward.
#pragma once

#include "engine/neural/diffusion/unet.h"

namespace gse::neural {

struct TransformerShape {
    std::int64_t channels = 0, heads = 8, context_width = 768, groups = 32;
    bool linear_projection = false;
    bool upcast = false;
};

/// to_q, to_k, to_v without bias and to_out.0.
class AttentionImpl : public torch::nn::Module {
public:
    AttentionImpl(std::int64_t channels, std::int64_t context_width, std::int64_t heads, bool upcast,
                  const WeightOptions& options);
    AttentionResult forward(const torch::Tensor& x, const torch::Tensor& context,
                            bool want_probabilities) const;

private:
    std::int64_t heads_;
    bool upcast_;
    Linear to_q{nullptr}, to_k{nullptr}, to_v{nullptr}, to_out{nullptr};
};
TORCH_MODULE(Attention);

/// Linear to twice the inner width, first half times gelu(second half), Linear back.
class FeedForwardImpl : public torch::nn::Module {
public:
    FeedForwardImpl(std::int64_t channels, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    Linear proj{nullptr}, out{nullptr};
};
TORCH_MODULE(FeedForward);

/// Origin of a captured map.
struct CaptureSite {
    AttentionCapture* capture = nullptr;
    std::string layer;
    std::int64_t height = 0, width = 0;
    std::int64_t together = 1;  // as in SceneViews
};

class TransformerBlockImpl : public torch::nn::Module {
public:
    TransformerBlockImpl(const TransformerShape& shape, const WeightOptions& options);
    torch::Tensor forward(torch::Tensor tokens, const torch::Tensor& context, const CaptureSite& site) const;

private:
    LayerNorm norm1{nullptr}, norm2{nullptr}, norm3{nullptr};
    Attention attn1{nullptr}, attn2{nullptr};
    FeedForward ff{nullptr};
};
TORCH_MODULE(TransformerBlock);

/// norm, proj_in, transformer_blocks.0, proj_out, residual; on [B,C,H,W].
class SpatialTransformerImpl : public torch::nn::Module {
public:
    SpatialTransformerImpl(const TransformerShape& shape, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x, const torch::Tensor& context, AttentionCapture* capture,
                          std::int64_t together = 1) const;
    std::string layer_name;  // where it stands in the UNet, for captures
    std::string capture_name() const { return layer_name + ".transformer_blocks.0.attn2"; }

private:
    GroupNorm norm{nullptr};
    Linear proj_in{nullptr}, proj_out{nullptr};
    TransformerBlock block{nullptr};
};
TORCH_MODULE(SpatialTransformer);

}  // namespace gse::neural
