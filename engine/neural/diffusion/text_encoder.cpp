// CLIP text encoder.
#include "engine/neural/diffusion/text_encoder.h"

#include <limits>

#include "engine/base/check.h"

namespace gse::neural {
namespace {

constexpr double TokenStd = 0.02, PositionStd = 0.01;  // CLIP's initial values
constexpr std::int64_t LegacyEosId = 2;

// Additive mask [B or 1,1,T,T]: lowest float above the diagonal and in columns that attention_mask rules out.
torch::Tensor causal_mask(std::int64_t tokens, const torch::Tensor& attention_mask,
                          const torch::Device& device) {
    auto blocked =
        torch::ones({tokens, tokens}, torch::TensorOptions().dtype(torch::kBool).device(device)).triu(1);
    blocked = blocked.view({1, 1, tokens, tokens});
    if (attention_mask.defined())
        blocked = blocked.logical_or(attention_mask.to(device).eq(0).view({-1, 1, 1, tokens}));
    const auto zero = torch::zeros({1}, torch::TensorOptions().dtype(torch::kFloat32).device(device));
    return zero.expand_as(blocked).masked_fill(blocked, std::numeric_limits<float>::lowest());
}

}  // namespace

ClipLayerImpl::ClipLayerImpl(const Shape& shape, const WeightOptions& options)
    : heads_(shape.heads), quick_gelu_(shape.activation == "quick_gelu") {
    const auto width = shape.width, inner = shape.inner;
    auto self_attn = std::make_shared<torch::nn::Module>();
    k_proj = self_attn->register_module("k_proj", Linear(LinearImpl::Shape{width, width}, options));
    v_proj = self_attn->register_module("v_proj", Linear(LinearImpl::Shape{width, width}, options));
    q_proj = self_attn->register_module("q_proj", Linear(LinearImpl::Shape{width, width}, options));
    out_proj = self_attn->register_module("out_proj", Linear(LinearImpl::Shape{width, width}, options));
    register_module("self_attn", self_attn);
    layer_norm1 = register_module("layer_norm1", LayerNorm(width, shape.norm_eps, options));
    auto mlp = std::make_shared<torch::nn::Module>();
    fc1 = mlp->register_module("fc1", Linear(LinearImpl::Shape{width, inner}, options));
    fc2 = mlp->register_module("fc2", Linear(LinearImpl::Shape{inner, width}, options));
    register_module("mlp", mlp);
    layer_norm2 = register_module("layer_norm2", LayerNorm(width, shape.norm_eps, options));
}

torch::Tensor ClipLayerImpl::forward(torch::Tensor x, const torch::Tensor& mask) const {
    AttentionRequest request;
    request.heads = heads_;
    request.mask = mask;
    const auto normed = layer_norm1->forward(x);
    const auto attended =
        attend(q_proj->forward(normed), k_proj->forward(normed), v_proj->forward(normed), request);
    x = x + out_proj->forward(attended.output);
    auto inner = fc1->forward(layer_norm2->forward(x));
    inner = quick_gelu_ ? inner * torch::sigmoid(inner * 1.702) : torch::gelu(inner);
    return x + fc2->forward(inner);
}

ClipTextEncoderImpl::ClipTextEncoderImpl(const TextEncoderConfig& config, const WeightOptions& options)
    : config_(config) {
    auto model = std::make_shared<torch::nn::Module>();
    auto embeddings = std::make_shared<torch::nn::Module>();
    token_embedding = embeddings->register_module(
        "token_embedding", Embedding(config_.vocab_size, config_.hidden_size, TokenStd, options));
    position_embedding = embeddings->register_module(
        "position_embedding",
        Embedding(config_.max_position_embeddings, config_.hidden_size, PositionStd, options));
    model->register_module("embeddings", embeddings);
    auto encoder = std::make_shared<torch::nn::Module>();
    for (std::int64_t i = 0; i < config_.num_hidden_layers; ++i)
        layers_.push_back(ClipLayer(
            ClipLayerImpl::Shape{config_.hidden_size, config_.intermediate_size, config_.num_attention_heads,
                                 config_.hidden_act, config_.layer_norm_eps},
            options));
    register_list(*encoder, "layers", layers_);
    model->register_module("encoder", encoder);
    final_layer_norm = model->register_module(
        "final_layer_norm", LayerNorm(config_.hidden_size, config_.layer_norm_eps, options));
    register_module("text_model", model);
    if (config_.with_projection)
        text_projection = register_module(
            "text_projection",
            Linear(LinearImpl::Shape{config_.hidden_size, config_.projection_dim, false}, options));
}

TextEncoding ClipTextEncoderImpl::forward(const torch::Tensor& ids,
                                          const torch::Tensor& attention_mask) const {
    const auto tokens = ids.size(1);
    GSE_CHECK(tokens <= config_.max_position_embeddings);
    TextEncoding result;
    auto x = token_embedding->forward(ids) + position_embedding->weight.narrow(0, 0, tokens);
    const auto mask = causal_mask(tokens, attention_mask, x.device());
    result.hidden_states.push_back(x);
    for (const auto& layer : layers_) {
        x = layer->forward(x, mask);
        result.hidden_states.push_back(x);
    }
    result.last_hidden = final_layer_norm->forward(x);
    const auto end = config_.eos_token_id == LegacyEosId
                         ? ids.argmax(1)
                         : ids.eq(config_.eos_token_id).to(torch::kInt32).argmax(1);
    const auto rows =
        torch::arange(ids.size(0), torch::TensorOptions().dtype(torch::kInt64).device(ids.device()));
    result.pooled = result.last_hidden.index({rows, end});
    if (!text_projection.is_empty()) result.text_embeds = text_projection->forward(result.pooled);
    return result;
}

}  // namespace gse::neural
