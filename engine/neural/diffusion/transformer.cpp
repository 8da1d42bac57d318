// Spatial transformer of the UNet.
#include "engine/neural/diffusion/transformer.h"

#include <algorithm>

namespace gse::neural {
namespace {

constexpr double TransformerNormEps = 1e-6;  // hard-wired in the reference, unlike norm_eps of the resnets
constexpr double LayerNormEps = 1e-5;
constexpr std::int64_t FeedForwardFactor = 4;

void store(const torch::Tensor& probabilities, const CaptureSite& site) {
    const auto& capture = *site.capture;
    auto kept = capture.keep_graph ? probabilities : probabilities.detach();
    if (capture.conditional_half_only) {
        const auto half = kept.size(0) / 2;
        kept = kept.narrow(0, half, half);
    }
    if (!capture.columns.empty())
        kept = kept.index_select(3, torch::tensor(capture.columns, torch::kInt64).to(kept.device()));
    site.capture->maps.push_back({site.layer, site.height, site.width, kept});
}

void store_affinity(const torch::Tensor& probabilities, const CaptureSite& site) {
    auto kept = probabilities.detach();
    if (site.capture->conditional_half_only) {
        const auto half = kept.size(0) / 2;
        kept = kept.narrow(0, half, half);
    }
    site.capture->affinities.push_back({site.layer, site.height, site.width, kept.mean(1)});
}

}  // namespace

AttentionImpl::AttentionImpl(std::int64_t channels, std::int64_t context_width, std::int64_t heads,
                             bool upcast, const WeightOptions& options)
    : heads_(heads), upcast_(upcast) {
    to_q = register_module("to_q", Linear(LinearImpl::Shape{channels, channels, false}, options));
    to_k = register_module("to_k", Linear(LinearImpl::Shape{context_width, channels, false}, options));
    to_v = register_module("to_v", Linear(LinearImpl::Shape{context_width, channels, false}, options));
    to_out = register_list(*this, "to_out",
                           std::vector{Linear(LinearImpl::Shape{channels, channels}, options)})[0];
}

AttentionResult AttentionImpl::forward(const torch::Tensor& x, const torch::Tensor& context,
                                       bool want_probabilities) const {
    AttentionRequest request;
    request.heads = heads_;
    request.upcast = upcast_;
    request.want_probabilities = want_probabilities;
    auto result = attend(to_q->forward(x), to_k->forward(context), to_v->forward(context), request);
    result.output = to_out->forward(result.output);
    return result;
}

FeedForwardImpl::FeedForwardImpl(std::int64_t channels, const WeightOptions& options) {
    const auto inner = channels * FeedForwardFactor;
    // Names in the reference: ff.net.0.proj, ff.net.1 (dropout, no weights), ff.net.2.
    torch::nn::ModuleList net;
    auto gate = std::make_shared<torch::nn::Module>();
    proj = gate->register_module("proj", Linear(LinearImpl::Shape{channels, inner * 2}, options));
    out = Linear(LinearImpl::Shape{inner, channels}, options);
    net->push_back(gate);
    net->push_back(std::make_shared<torch::nn::Module>());
    net->push_back(out.ptr());
    register_module("net", net);
}

torch::Tensor FeedForwardImpl::forward(const torch::Tensor& x) const {
    const auto halves = proj->forward(x).chunk(2, -1);
    return out->forward(halves[0] * torch::gelu(halves[1]));
}

TransformerBlockImpl::TransformerBlockImpl(const TransformerShape& shape, const WeightOptions& options) {
    const auto width = shape.channels;
    norm1 = register_module("norm1", LayerNorm(width, LayerNormEps, options));
    attn1 = register_module("attn1", Attention(width, width, shape.heads, shape.upcast, options));
    norm2 = register_module("norm2", LayerNorm(width, LayerNormEps, options));
    attn2 =
        register_module("attn2", Attention(width, shape.context_width, shape.heads, shape.upcast, options));
    norm3 = register_module("norm3", LayerNorm(width, LayerNormEps, options));
    ff = register_module("ff", FeedForward(width, options));
}

torch::Tensor TransformerBlockImpl::forward(torch::Tensor tokens, const torch::Tensor& context,
                                            const CaptureSite& site) const {
    const bool wanted = site.capture != nullptr &&
                        (!site.capture->wants || site.capture->wants(site.layer, site.height, site.width));
    const bool affine = wanted && site.together == 1 &&
                        std::max(site.height, site.width) <= site.capture->self_attention_side;
    auto normed = norm1->forward(tokens);
    if (site.together > 1)
        // The tokens of all views.
        normed = normed.reshape({tokens.size(0) / site.together, -1, tokens.size(2)});
    const auto attended = attn1->forward(normed, normed, affine);
    if (affine) store_affinity(attended.probabilities, site);
    tokens = tokens + attended.output.reshape(tokens.sizes());
    const auto crossed = attn2->forward(norm2->forward(tokens), context, wanted);
    if (wanted) store(crossed.probabilities, site);
    tokens = tokens + crossed.output;
    return tokens + ff->forward(norm3->forward(tokens));
}

SpatialTransformerImpl::SpatialTransformerImpl(const TransformerShape& shape, const WeightOptions& options) {
    const LinearImpl::Shape square{shape.channels, shape.channels, true, !shape.linear_projection};
    norm = register_module("norm", GroupNorm(shape.channels, shape.groups, TransformerNormEps, options));
    proj_in = register_module("proj_in", Linear(square, options));
    block = register_list(*this, "transformer_blocks", std::vector{TransformerBlock(shape, options)})[0];
    proj_out = register_module("proj_out", Linear(square, options));
}

torch::Tensor SpatialTransformerImpl::forward(const torch::Tensor& x, const torch::Tensor& context,
                                              AttentionCapture* capture, std::int64_t together) const {
    const auto height = x.size(2), width = x.size(3);
    auto tokens = proj_in->forward(image_to_tokens(norm->forward(x)));
    tokens = block->forward(
        tokens, context,
        {capture, capture == nullptr ? std::string() : capture_name(), height, width, together});
    return x + tokens_to_image(proj_out->forward(tokens), height, width);
}

}  // namespace gse::neural
