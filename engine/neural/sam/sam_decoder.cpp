// Prompt encoder, two-way transformer and mask head, with the names of segment-anything.
#include "engine/neural/sam/sam_decoder.h"

#include <cmath>
#include <utility>

#include "engine/base/check.h"

namespace gse::neural {
namespace {

constexpr double DecoderNormEps = 1e-5;
constexpr std::int64_t AttentionReduction = 2;  // of the widths of attention between tokens and picture

torch::Tensor transposed_convolution(const torch::Tensor& x, const torch::Tensor& weight,
                                     const torch::Tensor& bias) {
    return torch::conv_transpose2d(x, weight, bias, 2);
}

}  // namespace

/// Linear layers with ReLU between them.
class SamPerceptronImpl : public torch::nn::Module {
public:
    SamPerceptronImpl(std::int64_t in, std::int64_t inner, std::int64_t out, std::int64_t count,
                      const WeightOptions& options) {
        for (std::int64_t i = 0; i < count; ++i)
            layers_.push_back(
                Linear(LinearImpl::Shape{i == 0 ? in : inner, i + 1 == count ? out : inner}, options));
        register_list(*this, "layers", layers_);
    }
    torch::Tensor forward(torch::Tensor x) const {
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            x = layers_[i]->forward(x);
            if (i + 1 < layers_.size()) x = torch::relu(x);
        }
        return x;
    }

private:
    std::vector<Linear> layers_;
};

class SamCrossAttentionImpl : public torch::nn::Module {
public:
    SamCrossAttentionImpl(std::int64_t width, std::int64_t inner, std::int64_t heads,
                          const WeightOptions& options)
        : heads_(heads) {
        q_ = register_module("q_proj", Linear(LinearImpl::Shape{width, inner}, options));
        k_ = register_module("k_proj", Linear(LinearImpl::Shape{width, inner}, options));
        v_ = register_module("v_proj", Linear(LinearImpl::Shape{width, inner}, options));
        out_ = register_module("out_proj", Linear(LinearImpl::Shape{inner, width}, options));
    }
    torch::Tensor forward(const torch::Tensor& q, const torch::Tensor& k, const torch::Tensor& v) const {
        return out_->forward(
            attend(q_->forward(q), k_->forward(k), v_->forward(v), AttentionRequest{heads_, false, {}, false})
                .output);
    }

private:
    std::int64_t heads_;
    Linear q_{nullptr}, k_{nullptr}, v_{nullptr}, out_{nullptr};
};
TORCH_MODULE(SamCrossAttention);

/// Tokens look at each other and at the picture, and the picture at them.
class SamTwoWayLayerImpl : public torch::nn::Module {
public:
    SamTwoWayLayerImpl(const SamDecoderShape& shape, bool first, const WeightOptions& options)
        : first_(first) {
        const auto width = shape.width, reduced = width / AttentionReduction;
        self_ = register_module("self_attn", SamCrossAttention(width, width, shape.heads, options));
        to_image_ = register_module("cross_attn_token_to_image",
                                    SamCrossAttention(width, reduced, shape.heads, options));
        to_tokens_ = register_module("cross_attn_image_to_token",
                                     SamCrossAttention(width, reduced, shape.heads, options));
        for (int i = 0; i < 4; ++i)
            norms_.push_back(
                register_module("norm" + std::to_string(i + 1), LayerNorm(width, DecoderNormEps, options)));
        auto mlp = std::make_shared<torch::nn::Module>();
        lin1_ = mlp->register_module("lin1", Linear(LinearImpl::Shape{width, shape.inner}, options));
        lin2_ = mlp->register_module("lin2", Linear(LinearImpl::Shape{shape.inner, width}, options));
        register_module("mlp", mlp);
    }

    void forward(torch::Tensor& tokens, torch::Tensor& image, const torch::Tensor& token_positions,
                 const torch::Tensor& image_positions) const {
        if (first_) {  // nothing was seen yet: what the tokens are is where they are
            tokens = self_->forward(tokens, tokens, tokens);
        } else {
            const auto placed = tokens + token_positions;
            tokens = tokens + self_->forward(placed, placed, tokens);
        }
        tokens = norms_[0]->forward(tokens);
        tokens = norms_[1]->forward(
            tokens + to_image_->forward(tokens + token_positions, image + image_positions, image));
        tokens = norms_[2]->forward(tokens + lin2_->forward(torch::relu(lin1_->forward(tokens))));
        image = norms_[3]->forward(
            image + to_tokens_->forward(image + image_positions, tokens + token_positions, tokens));
    }

private:
    bool first_;
    SamCrossAttention self_{nullptr}, to_image_{nullptr}, to_tokens_{nullptr};
    std::vector<LayerNorm> norms_;
    Linear lin1_{nullptr}, lin2_{nullptr};
};
TORCH_MODULE(SamTwoWayLayer);

class SamTransformerImpl : public torch::nn::Module {
public:
    SamTransformerImpl(const SamDecoderShape& shape, const WeightOptions& options) {
        for (std::int64_t i = 0; i < shape.layers; ++i)
            layers_.push_back(SamTwoWayLayer(shape, i == 0, options));
        register_list(*this, "layers", layers_);
        final_ = register_module(
            "final_attn_token_to_image",
            SamCrossAttention(shape.width, shape.width / AttentionReduction, shape.heads, options));
        norm_ = register_module("norm_final_attn", LayerNorm(shape.width, DecoderNormEps, options));
    }

    /// Tokens [B,n,C] and picture [B,hw,C], which also say where they are.
    std::pair<torch::Tensor, torch::Tensor> forward(const torch::Tensor& prompts, torch::Tensor image,
                                                    const torch::Tensor& positions) const {
        auto tokens = prompts;
        for (const auto& layer : layers_) layer->forward(tokens, image, prompts, positions);
        tokens = norm_->forward(tokens + final_->forward(tokens + prompts, image + positions, image));
        return {tokens, image};
    }

private:
    std::vector<SamTwoWayLayer> layers_;
    SamCrossAttention final_{nullptr};
    LayerNorm norm_{nullptr};
};

SamPromptEncoderImpl::SamPromptEncoderImpl(const SamDecoderShape& shape, const WeightOptions& options)
    : shape_(shape) {
    const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
    const auto width = shape.width, middle = shape.mask_channels;
    auto positions = std::make_shared<torch::nn::Module>();
    frequencies_ = positions->register_parameter("positional_encoding_gaussian_matrix",
                                                 torch::zeros({2, width / 2}, as));
    register_module("pe_layer", positions);
    for (int i = 0; i < 4; ++i) kinds_.push_back(Embedding(1, width, 1.0, options));
    register_list(*this, "point_embeddings", kinds_);
    not_a_point_ = register_module("not_a_point_embed", Embedding(1, width, 1.0, options));
    no_mask_ = register_module("no_mask_embed", Embedding(1, width, 1.0, options));
    auto mask = std::make_shared<torch::nn::Module>();
    mask_first_ = mask->register_module("0", Conv2d(Conv2dImpl::Shape{1, middle / 4, 2, 2, 0}, options));
    mask_first_norm_ = mask->register_module("1", ChannelNorm(middle / 4, options));
    mask_second_ =
        mask->register_module("3", Conv2d(Conv2dImpl::Shape{middle / 4, middle, 2, 2, 0}, options));
    mask_second_norm_ = mask->register_module("4", ChannelNorm(middle, options));
    mask_third_ = mask->register_module("6", Conv2d(Conv2dImpl::Shape{middle, width, 1, 1, 0}, options));
    register_module("mask_downscaling", mask);
}

/// Random Fourier features of places [..,2] in [0,1].
torch::Tensor SamPromptEncoderImpl::encode(const torch::Tensor& places) const {
    const auto angles = torch::matmul(2 * places - 1, frequencies_) * (2 * M_PI);
    return torch::cat({angles.sin(), angles.cos()}, -1);
}

torch::Tensor SamPromptEncoderImpl::encode_points(const SamPrompts& prompts) const {
    auto places = prompts.points + 0.5;  // the middle of a pixel
    auto labels = prompts.labels;
    if (!prompts.boxes.defined()) {  // the decoder was trained with at least two points
        places = torch::cat({places, torch::zeros({places.size(0), 1, 2}, places.options())}, 1);
        labels = torch::cat({labels, torch::full({labels.size(0), 1}, -1, labels.options())}, 1);
    }
    const auto label = labels.unsqueeze(-1);
    auto encoded = encode(places / static_cast<double>(shape_.image_size));
    encoded = torch::where(label == -1, not_a_point_->weight.unsqueeze(0), encoded);
    encoded = encoded + (label == 0).to(encoded.scalar_type()) * kinds_[0]->weight;
    return encoded + (label == 1).to(encoded.scalar_type()) * kinds_[1]->weight;
}

torch::Tensor SamPromptEncoderImpl::encode_boxes(const torch::Tensor& boxes) const {
    const auto corners = (boxes + 0.5).view({-1, 2, 2}) / static_cast<double>(shape_.image_size);
    return encode(corners) + torch::cat({kinds_[2]->weight, kinds_[3]->weight}).unsqueeze(0);
}

torch::Tensor SamPromptEncoderImpl::encode_mask(const torch::Tensor& mask) const {
    auto x = torch::gelu(mask_first_norm_->forward(mask_first_->forward(mask)));
    x = torch::gelu(mask_second_norm_->forward(mask_second_->forward(x)));
    return mask_third_->forward(x);
}

SamPromptEncoding SamPromptEncoderImpl::forward(const SamPrompts& prompts) const {
    std::vector<torch::Tensor> sparse;
    if (prompts.points.defined()) sparse.push_back(encode_points(prompts));
    if (prompts.boxes.defined()) sparse.push_back(encode_boxes(prompts.boxes));
    SamPromptEncoding result;
    result.sparse =
        sparse.empty() ? torch::zeros({1, 0, shape_.width}, frequencies_.options()) : torch::cat(sparse, 1);
    const auto batch = result.sparse.size(0);
    result.dense =
        prompts.mask.defined()
            ? encode_mask(prompts.mask)
            : no_mask_->weight.view({1, -1, 1, 1}).expand({batch, shape_.width, shape_.side, shape_.side});
    return result;
}

torch::Tensor SamPromptEncoderImpl::dense_positions() const {
    const auto place =
        (torch::arange(shape_.side, frequencies_.options()) + 0.5) / static_cast<double>(shape_.side);
    const auto grid = torch::stack({place.unsqueeze(0).expand({shape_.side, shape_.side}),
                                    place.unsqueeze(1).expand({shape_.side, shape_.side})},
                                   -1);
    return encode(grid).permute({2, 0, 1}).unsqueeze(0);
}

SamMaskDecoderImpl::SamMaskDecoderImpl(const SamDecoderShape& shape, const WeightOptions& options)
    : shape_(shape) {
    const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
    const auto width = shape.width, quarter = width / 4, eighth = width / 8;
    transformer_ = register_module("transformer", std::make_shared<SamTransformerImpl>(shape, options));
    iou_token_ = register_module("iou_token", Embedding(1, width, 1.0, options));
    mask_tokens_ = register_module("mask_tokens", Embedding(shape.mask_tokens, width, 1.0, options));
    auto enlarging = std::make_shared<torch::nn::Module>(), first = std::make_shared<torch::nn::Module>(),
         second = std::make_shared<torch::nn::Module>();
    first_weight_ = first->register_parameter("weight", torch::zeros({width, quarter, 2, 2}, as));
    first_bias_ = first->register_parameter("bias", torch::zeros({quarter}, as));
    second_weight_ = second->register_parameter("weight", torch::zeros({quarter, eighth, 2, 2}, as));
    second_bias_ = second->register_parameter("bias", torch::zeros({eighth}, as));
    enlarging->register_module("0", first);
    enlarging_norm_ = enlarging->register_module("1", ChannelNorm(quarter, options));
    enlarging->register_module("3", second);
    register_module("output_upscaling", enlarging);
    torch::nn::ModuleList list;
    for (std::int64_t i = 0; i < shape.mask_tokens; ++i) {
        hypernetworks_.push_back(std::make_shared<SamPerceptronImpl>(width, width, eighth, 3, options));
        list->push_back(hypernetworks_.back());
    }
    register_module("output_hypernetworks_mlps", list);
    iou_head_ = register_module("iou_prediction_head",
                                std::make_shared<SamPerceptronImpl>(width, shape.iou_inner, shape.mask_tokens,
                                                                    shape.iou_layers, options));
}

SamMasks SamMaskDecoderImpl::forward(const torch::Tensor& embedding, const torch::Tensor& positions,
                                     const SamPromptEncoding& prompts, bool several) const {
    const auto batch = prompts.sparse.size(0), side = shape_.side, count = shape_.mask_tokens;
    const auto own =
        torch::cat({iou_token_->weight, mask_tokens_->weight}).unsqueeze(0).expand({batch, -1, -1});
    const auto tokens = torch::cat({own, prompts.sparse}, 1);
    const auto image = image_to_tokens(embedding + prompts.dense).contiguous();
    const auto [told, seen] = transformer_->forward(tokens, image, image_to_tokens(positions).contiguous());
    auto large = transposed_convolution(tokens_to_image(seen.contiguous(), side, side).contiguous(),
                                        first_weight_, first_bias_);
    large = torch::gelu(enlarging_norm_->forward(large));
    large = torch::gelu(transposed_convolution(large, second_weight_, second_bias_));
    std::vector<torch::Tensor> kernels;
    for (std::int64_t i = 0; i < count; ++i)
        kernels.push_back(hypernetworks_[static_cast<std::size_t>(i)]->forward(told.select(1, 1 + i)));
    const auto logits =
        torch::matmul(torch::stack(kernels, 1), large.flatten(2)).view({batch, count, 4 * side, 4 * side});
    const auto iou = iou_head_->forward(told.select(1, 0));
    if (several) return {logits.narrow(1, 1, count - 1), iou.narrow(1, 1, count - 1)};
    return {logits.narrow(1, 0, 1), iou.narrow(1, 0, 1)};
}

}  // namespace gse::neural
