// Layers: allocation, initial values and forward passes.
#include "engine/neural/layers/layers.h"

#include <algorithm>
#include <cmath>

#include "engine/neural/api/network_use.h"

namespace gse::neural {

NetworkUse& thread_use() {
    thread_local NetworkUse use;
    return use;
}

namespace {

// Scores above this many numbers are computed in pieces (64 MB in fp32).
constexpr std::int64_t ScoreBudget = 16 * 1024 * 1024;

torch::Tensor make_parameter(torch::nn::Module& module, const char* name, torch::IntArrayRef shape,
                             const WeightOptions& options) {
    return module.register_parameter(
        name, torch::empty(shape, torch::TensorOptions().device(options.device).dtype(options.dtype)));
}

void draw_uniform(torch::Tensor weight, torch::Tensor bias) {
    const torch::NoGradGuard no_grad;
    if (weight.is_meta()) return;
    const double bound = 1.0 / std::sqrt(static_cast<double>(weight.numel() / weight.size(0)));
    weight.uniform_(-bound, bound);
    if (bias.defined()) bias.uniform_(-bound, bound);
}

void fill_affine(torch::Tensor weight, torch::Tensor bias) {
    const torch::NoGradGuard no_grad;
    if (weight.is_meta()) return;
    weight.fill_(1.0);
    bias.zero_();
}

void count_products(std::int64_t products) { thread_use().flop += 2.0 * static_cast<double>(products); }

bool is_reduced(const torch::Tensor& x) {
    return x.scalar_type() == torch::kHalf || x.scalar_type() == torch::kBFloat16;
}

}  // namespace

LinearImpl::LinearImpl(const Shape& shape, const WeightOptions& options) {
    weight = shape.as_convolution ? make_parameter(*this, "weight", {shape.out, shape.in, 1, 1}, options)
                                  : make_parameter(*this, "weight", {shape.out, shape.in}, options);
    if (shape.bias) bias = make_parameter(*this, "bias", {shape.out}, options);
    if (options.initialize) LinearImpl::reset();
}

void LinearImpl::reset() { draw_uniform(weight, bias); }

torch::Tensor LinearImpl::forward(const torch::Tensor& x) const {
    count_products(x.numel() * weight.size(0));
    return torch::linear(x, weight.dim() == 4 ? weight.flatten(1) : weight, bias);
}

Conv2dImpl::Conv2dImpl(const Shape& shape, const WeightOptions& options) : shape_(shape) {
    weight = make_parameter(*this, "weight", {shape.out, shape.in, shape.kernel, shape.kernel}, options);
    if (shape.bias) bias = make_parameter(*this, "bias", {shape.out}, options);
    if (options.initialize) Conv2dImpl::reset();
}

void Conv2dImpl::reset() { draw_uniform(weight, bias); }

torch::Tensor Conv2dImpl::forward(const torch::Tensor& x) const {
    auto result = torch::conv2d(x, weight, bias, shape_.stride, shape_.padding);
    count_products(result.numel() * shape_.in * shape_.kernel * shape_.kernel);
    return result;
}

GroupNormImpl::GroupNormImpl(std::int64_t channels, std::int64_t groups, double eps,
                             const WeightOptions& options)
    : groups_(groups), eps_(eps) {
    weight = make_parameter(*this, "weight", {channels}, options);
    bias = make_parameter(*this, "bias", {channels}, options);
    if (options.initialize) GroupNormImpl::reset();
}

void GroupNormImpl::reset() { fill_affine(weight, bias); }

torch::Tensor GroupNormImpl::forward(const torch::Tensor& x) const {
    if (!is_reduced(x)) return torch::group_norm(x, groups_, weight, bias, eps_);
    return torch::group_norm(x.to(torch::kFloat32), groups_, weight.to(torch::kFloat32),
                             bias.to(torch::kFloat32), eps_)
        .to(x.scalar_type());
}

torch::Tensor GroupNormImpl::forward_silu(const torch::Tensor& x) const { return apply_silu(forward(x)); }

LayerNormImpl::LayerNormImpl(std::int64_t width, double eps, const WeightOptions& options) : eps_(eps) {
    weight = make_parameter(*this, "weight", {width}, options);
    bias = make_parameter(*this, "bias", {width}, options);
    if (options.initialize) LayerNormImpl::reset();
}

void LayerNormImpl::reset() { fill_affine(weight, bias); }

torch::Tensor LayerNormImpl::forward(const torch::Tensor& x) const {
    if (!is_reduced(x)) return torch::layer_norm(x, weight.sizes(), weight, bias, eps_);
    return torch::layer_norm(x.to(torch::kFloat32), weight.sizes(), weight.to(torch::kFloat32),
                             bias.to(torch::kFloat32), eps_)
        .to(x.scalar_type());
}

EmbeddingImpl::EmbeddingImpl(std::int64_t count, std::int64_t width, double initial_std,
                             const WeightOptions& options)
    : initial_std_(initial_std) {
    weight = make_parameter(*this, "weight", {count, width}, options);
    if (options.initialize) EmbeddingImpl::reset();
}

void EmbeddingImpl::reset() {
    const torch::NoGradGuard no_grad;
    if (!weight.is_meta()) weight.normal_(0.0, initial_std_);
}

torch::Tensor EmbeddingImpl::forward(const torch::Tensor& ids) const { return torch::embedding(weight, ids); }

void init_weights(torch::nn::Module& module, std::uint64_t seed) {
    torch::manual_seed(seed);
    for (const auto& child : module.modules())
        if (auto* layer = dynamic_cast<Resettable*>(child.get())) layer->reset();
}

torch::Tensor apply_silu(torch::Tensor x) {
    return torch::GradMode::is_enabled() && x.requires_grad() ? torch::silu(x) : torch::silu_(x);
}

namespace {

// q, k, v are [B*heads, N or M, d], q already scaled.
torch::Tensor probabilities_of(const torch::Tensor& q, const torch::Tensor& k,
                               const AttentionRequest& request, std::int64_t batch) {
    auto scores = torch::bmm(q, k.transpose(1, 2));
    if (request.mask.defined())
        scores = (scores.view({batch, request.heads, q.size(1), k.size(1)}) + request.mask).view_as(scores);
    return torch::softmax(scores, -1, torch::kFloat32);
}

torch::Tensor split_heads(const torch::Tensor& x, std::int64_t heads) {
    const auto batch = x.size(0), tokens = x.size(1), width = x.size(2) / heads;
    return x.view({batch, tokens, heads, width}).transpose(1, 2).reshape({batch * heads, tokens, width});
}

torch::Tensor merge_heads(const torch::Tensor& x, std::int64_t heads) {
    const auto batch = x.size(0) / heads, tokens = x.size(1), width = x.size(2);
    return x.view({batch, heads, tokens, width}).transpose(1, 2).reshape({batch, tokens, heads * width});
}

torch::Tensor attend_in_pieces(const torch::Tensor& q, const torch::Tensor& k, const torch::Tensor& v,
                               const AttentionRequest& request) {
    auto output = torch::empty_like(v.size(1) == q.size(1) ? v : q);
    const auto rows = std::max<std::int64_t>(1, ScoreBudget / (q.size(1) * k.size(1)));
    const AttentionRequest plain{request.heads, request.upcast, {}, false};
    for (std::int64_t first = 0; first < q.size(0); first += rows) {
        const auto count = std::min(rows, q.size(0) - first);
        const auto weights = probabilities_of(q.narrow(0, first, count), k.narrow(0, first, count), plain, 1);
        auto piece = output.narrow(0, first, count);
        piece.copy_(torch::bmm(weights.to(v.scalar_type()), v.narrow(0, first, count)));
    }
    return output;
}

}  // namespace

AttentionResult attend(const torch::Tensor& q_in, const torch::Tensor& k_in, const torch::Tensor& v_in,
                       const AttentionRequest& request) {
    const auto batch = q_in.size(0);
    count_products(q_in.numel() * k_in.size(1) + q_in.size(1) * v_in.numel());
    const double scale = 1.0 / std::sqrt(static_cast<double>(q_in.size(2) / request.heads));
    auto q = split_heads(q_in * scale, request.heads);
    auto k = split_heads(k_in, request.heads);
    const auto v = split_heads(v_in, request.heads);
    if (request.upcast && q.scalar_type() == torch::kHalf) {
        q = q.to(torch::kFloat32);
        k = k.to(torch::kFloat32);
    }
    AttentionResult result;
    const bool recorded =
        torch::GradMode::is_enabled() && (q.requires_grad() || k.requires_grad() || v.requires_grad());
    const bool large = q.size(0) * q.size(1) * k.size(1) > ScoreBudget;
    if (large && !recorded && !request.want_probabilities && !request.mask.defined()) {
        result.output = merge_heads(attend_in_pieces(q, k, v, request), request.heads);
        return result;
    }
    const auto weights = probabilities_of(q, k, request, batch);
    result.output = merge_heads(torch::bmm(weights.to(v.scalar_type()), v), request.heads);
    if (request.want_probabilities)
        result.probabilities = weights.view({batch, request.heads, q.size(1), k.size(1)});
    return result;
}

torch::Tensor image_to_tokens(const torch::Tensor& x) { return x.permute({0, 2, 3, 1}).flatten(1, 2); }

torch::Tensor tokens_to_image(const torch::Tensor& tokens, std::int64_t height, std::int64_t width) {
    return tokens.view({tokens.size(0), height, width, tokens.size(2)}).permute({0, 3, 1, 2});
}

}  // namespace gse::neural
