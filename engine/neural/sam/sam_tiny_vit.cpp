// TinyViT as MobileSAM has it: convolutions, then transformer blocks with windows, merged twice.
#include <algorithm>
#include <cmath>

#include "engine/neural/api/network_use.h"
#include "engine/neural/sam/sam_image_encoder.h"

namespace gse::neural {
namespace {

constexpr double BlockNormEps = 1e-5;
constexpr double BatchNormEps = 1e-5;
constexpr std::array<std::int64_t, 3> MergeStrides{2, 2, 1};

struct ConvolutionShape {
    std::int64_t in, out, kernel = 1, stride = 1, groups = 1;
};

/// Convolution and batch normalisation with the statistics of the training.
class NormedConvolutionImpl : public torch::nn::Module {
public:
    NormedConvolutionImpl(const ConvolutionShape& shape, const WeightOptions& options) : shape_(shape) {
        const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
        auto convolution = std::make_shared<torch::nn::Module>(),
             norm = std::make_shared<torch::nn::Module>();
        weight_ = convolution->register_parameter(
            "weight", torch::zeros({shape.out, shape.in / shape.groups, shape.kernel, shape.kernel}, as));
        scale_ = norm->register_parameter("weight", torch::ones({shape.out}, as));
        shift_ = norm->register_parameter("bias", torch::zeros({shape.out}, as));
        mean_ = norm->register_parameter("running_mean", torch::zeros({shape.out}, as), false);
        variance_ = norm->register_parameter("running_var", torch::ones({shape.out}, as), false);
        register_module("c", convolution);
        register_module("bn", norm);
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        const auto factor = scale_ / torch::sqrt(variance_ + BatchNormEps);
        auto result = torch::conv2d(x, weight_ * factor.view({-1, 1, 1, 1}), shift_ - mean_ * factor,
                                    shape_.stride, shape_.kernel / 2, 1, shape_.groups);
        thread_use().flop += 2.0 * static_cast<double>(result.numel() * shape_.in / shape_.groups *
                                                       shape_.kernel * shape_.kernel);
        return result;
    }

private:
    ConvolutionShape shape_;
    torch::Tensor weight_, scale_, shift_, mean_, variance_;
};
TORCH_MODULE(NormedConvolution);

/// 1x1, depthwise 3x3, 1x1, plus x, gelu.
class ConvolutionBlockImpl : public torch::nn::Module {
public:
    ConvolutionBlockImpl(std::int64_t width, std::int64_t inner, const WeightOptions& options) {
        conv1_ = register_module("conv1", NormedConvolution(ConvolutionShape{width, inner}, options));
        conv2_ =
            register_module("conv2", NormedConvolution(ConvolutionShape{inner, inner, 3, 1, inner}, options));
        conv3_ = register_module("conv3", NormedConvolution(ConvolutionShape{inner, width}, options));
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        return torch::gelu(x +
                           conv3_->forward(torch::gelu(conv2_->forward(torch::gelu(conv1_->forward(x))))));
    }

private:
    NormedConvolution conv1_{nullptr}, conv2_{nullptr}, conv3_{nullptr};
};
TORCH_MODULE(ConvolutionBlock);

/// 1x1, gelu, depthwise 3x3 with a stride, gelu, 1x1.
class MergingImpl : public torch::nn::Module {
public:
    MergingImpl(std::int64_t in, std::int64_t out, std::int64_t stride, const WeightOptions& options) {
        conv1_ = register_module("conv1", NormedConvolution(ConvolutionShape{in, out}, options));
        conv2_ =
            register_module("conv2", NormedConvolution(ConvolutionShape{out, out, 3, stride, out}, options));
        conv3_ = register_module("conv3", NormedConvolution(ConvolutionShape{out, out}, options));
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        return conv3_->forward(torch::gelu(conv2_->forward(torch::gelu(conv1_->forward(x)))));
    }

private:
    NormedConvolution conv1_{nullptr}, conv2_{nullptr}, conv3_{nullptr};
};
TORCH_MODULE(Merging);

/// Self-attention in a window with a learned bias for each pair of distances; the norm is inside, so that
/// what was padded counts.
class WindowAttentionImpl : public torch::nn::Module {
public:
    WindowAttentionImpl(std::int64_t width, std::int64_t heads, std::int64_t window,
                        const WeightOptions& options)
        : heads_(heads), window_(window) {
        norm_ = register_module("norm", LayerNorm(width, BlockNormEps, options));
        qkv_ = register_module("qkv", Linear(LinearImpl::Shape{width, 3 * width}, options));
        proj_ = register_module("proj", Linear(LinearImpl::Shape{width, width}, options));
        const auto as = torch::TensorOptions().device(options.device).dtype(options.dtype);
        biases_ = register_parameter("attention_biases", torch::zeros({heads, window * window}, as));
    }

    /// [windows, w*w, C].
    torch::Tensor forward(const torch::Tensor& x) const {
        const auto batch = x.size(0), tokens = x.size(1), width = x.size(2), depth = width / heads_;
        // The rows are q, k and v of one head, then those of the next.
        const auto qkv = qkv_->forward(norm_->forward(x))
                             .view({batch, tokens, heads_, 3, depth})
                             .permute({3, 0, 2, 1, 4})
                             .reshape({3, batch * heads_, tokens, depth});
        thread_use().flop += 4.0 * static_cast<double>(batch * heads_ * tokens * tokens * depth);
        auto scores =
            torch::bmm(qkv[0] * (1.0 / std::sqrt(static_cast<double>(depth))), qkv[1].transpose(1, 2));
        scores = scores.view({batch, heads_, tokens, tokens}) + pair_biases();
        const auto seen =
            torch::bmm(torch::softmax(scores, -1).view({batch * heads_, tokens, tokens}), qkv[2]);
        return proj_->forward(
            seen.view({batch, heads_, tokens, depth}).transpose(1, 2).reshape({batch, tokens, width}));
    }

private:
    /// [heads, w*w, w*w]: entry |dy| w + |dx| of each head's.
    torch::Tensor pair_biases() const {
        const auto place = torch::arange(
            window_ * window_, torch::TensorOptions().dtype(torch::kInt64).device(biases_.device()));
        const auto y = torch::div(place, window_, "floor"), x = place.remainder(window_);
        const auto distance =
            (y.unsqueeze(1) - y.unsqueeze(0)).abs() * window_ + (x.unsqueeze(1) - x.unsqueeze(0)).abs();
        return biases_.index_select(1, distance.flatten())
            .view({heads_, window_ * window_, window_ * window_});
    }

    std::int64_t heads_, window_;
    LayerNorm norm_{nullptr};
    Linear qkv_{nullptr}, proj_{nullptr};
    torch::Tensor biases_;
};
TORCH_MODULE(WindowAttention);

/// norm, fc1, gelu, fc2.
class TinyMlpImpl : public torch::nn::Module {
public:
    TinyMlpImpl(std::int64_t width, std::int64_t inner, const WeightOptions& options) {
        norm_ = register_module("norm", LayerNorm(width, BlockNormEps, options));
        fc1_ = register_module("fc1", Linear(LinearImpl::Shape{width, inner}, options));
        fc2_ = register_module("fc2", Linear(LinearImpl::Shape{inner, width}, options));
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        return fc2_->forward(torch::gelu(fc1_->forward(norm_->forward(x))));
    }

private:
    LayerNorm norm_{nullptr};
    Linear fc1_{nullptr}, fc2_{nullptr};
};
TORCH_MODULE(TinyMlp);

/// Windows, a depthwise convolution in place of its input, and the perceptron.
class TinyBlockOfTokensImpl : public torch::nn::Module {
public:
    TinyBlockOfTokensImpl(const TinyVitShape& shape, std::size_t layer, std::int64_t side,
                          const WeightOptions& options)
        : side_(side), window_(shape.windows[layer]) {
        const auto width = shape.widths[layer];
        attention_ = register_module("attn", WindowAttention(width, shape.heads[layer], window_, options));
        local_ = register_module("local_conv",
                                 NormedConvolution(ConvolutionShape{width, width, 3, 1, width}, options));
        mlp_ = register_module("mlp", TinyMlp(width, shape.inner[layer], options));
    }

    /// [B,N,C]; traces what the windows and the convolution give.
    torch::Tensor forward(const torch::Tensor& x, const std::string& name, SamTrace* trace) const {
        const auto batch = x.size(0), tokens = x.size(1), width = x.size(2);
        const auto note = [&](const char* what, const torch::Tensor& value) {
            if (trace != nullptr) trace->emplace_back(name + what, value);
        };
        torch::Tensor seen;
        if (window_ == side_) {
            seen = attention_->forward(x);
        } else {
            const auto windows =
                attention_->forward(to_windows(x.view({batch, side_, side_, width}), window_).flatten(1, 2));
            note(".attn_windows", windows);
            seen = from_windows(windows.view({-1, window_, window_, width}), window_, side_, side_)
                       .reshape({batch, tokens, width});
        }
        const auto map = (x + seen).transpose(1, 2).reshape({batch, width, side_, side_});
        const auto local = local_->forward(map);
        note(".local_conv", local);
        const auto mixed = local.flatten(2).transpose(1, 2).contiguous();
        return mixed + mlp_->forward(mixed);
    }

private:
    std::int64_t side_, window_;
    WindowAttention attention_{nullptr};
    NormedConvolution local_{nullptr};
    TinyMlp mlp_{nullptr};
};
TORCH_MODULE(TinyBlockOfTokens);

class TinyVitImpl final : public SamImageEncoderImpl {
public:
    TinyVitImpl(const TinyVitShape& shape, const WeightOptions& options) {
        add_patches(shape.widths[0], options);
        torch::nn::ModuleList layers;
        side_[0] = shape.image_size / 4;
        for (std::size_t i = 0; i < shape.widths.size(); ++i) {
            if (i > 0) side_[i] = (side_[i - 1] + MergeStrides[i - 1] - 1) / MergeStrides[i - 1];
            layers->push_back(make_layer(shape, i, options));
        }
        register_module("layers", layers);
        neck_ = register_module("neck", SamNeck(shape.widths.back(), shape.out, options));
    }

    torch::Tensor forward(const torch::Tensor& pixels, SamTrace* trace) const override {
        const auto note = [&](const std::string& name, const torch::Tensor& x) {
            if (trace != nullptr) trace->emplace_back(name, x);
        };
        auto x = second_patch_->forward(torch::gelu(first_patch_->forward(pixels)));
        note("enc.patch_embed", x);
        for (std::size_t i = 0; i < convolutions_.size(); ++i) {
            x = convolutions_[i]->forward(x);
            note("enc.layers.0.blocks." + std::to_string(i), x);
        }
        for (std::size_t layer = 1; layer < side_.size(); ++layer) {
            if (layer > 1) x = tokens_to_image(x, side_[layer - 1], side_[layer - 1]).contiguous();
            x = mergings_[layer - 1]->forward(x).flatten(2).transpose(1, 2).contiguous();
            note("enc.layers." + std::to_string(layer - 1) + ".downsample", x);
            for (std::size_t i = 0; i < blocks_[layer].size(); ++i) {
                const auto name = "enc.layers." + std::to_string(layer) + ".blocks." + std::to_string(i);
                x = blocks_[layer][i]->forward(x, name, trace);
                note(name, x);
            }
        }
        return neck_->forward(tokens_to_image(x, side_.back(), side_.back()).contiguous(), trace);
    }

private:
    void add_patches(std::int64_t width, const WeightOptions& options) {
        // "seq": a convolution, gelu (without weights), a convolution.
        auto sequence = std::make_shared<torch::nn::Module>(),
             patches = std::make_shared<torch::nn::Module>();
        first_patch_ =
            sequence->register_module("0", NormedConvolution(ConvolutionShape{3, width / 2, 3, 2}, options));
        second_patch_ = sequence->register_module(
            "2", NormedConvolution(ConvolutionShape{width / 2, width, 3, 2}, options));
        patches->register_module("seq", sequence);
        register_module("patch_embed", patches);
    }

    std::shared_ptr<torch::nn::Module> make_layer(const TinyVitShape& shape, std::size_t i,
                                                  const WeightOptions& options) {
        auto layer = std::make_shared<torch::nn::Module>();
        torch::nn::ModuleList blocks;
        for (std::int64_t k = 0; k < shape.depths[i]; ++k) {
            if (i == 0)
                blocks->push_back(
                    convolutions_
                        .emplace_back(ConvolutionBlock(shape.widths[0], shape.convolution_inner, options))
                        .ptr());
            else
                blocks->push_back(
                    blocks_[i].emplace_back(TinyBlockOfTokens(shape, i, side_[i], options)).ptr());
        }
        layer->register_module("blocks", blocks);
        if (i + 1 < shape.widths.size())
            mergings_.push_back(layer->register_module(
                "downsample", Merging(shape.widths[i], shape.widths[i + 1], MergeStrides[i], options)));
        return layer;
    }

    std::array<std::int64_t, 4> side_{};  // of the picture in pixels or tokens
    NormedConvolution first_patch_{nullptr}, second_patch_{nullptr};
    std::vector<ConvolutionBlock> convolutions_;
    std::array<std::vector<TinyBlockOfTokens>, 4> blocks_;
    std::vector<Merging> mergings_;
    SamNeck neck_{nullptr};
};

}  // namespace

std::shared_ptr<SamImageEncoderImpl> make_tiny_vit(const TinyVitShape& shape, const WeightOptions& options) {
    return std::make_shared<TinyVitImpl>(shape, options);
}

}  // namespace gse::neural
