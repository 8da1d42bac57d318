// The vision transformer of SAM, with the names of segment-anything.
#include <cmath>

#include "engine/neural/api/network_use.h"
#include "engine/neural/sam/sam_image_encoder.h"

namespace gse::neural {
namespace {

constexpr double EncoderNormEps = 1e-6;

torch::Tensor table(torch::nn::Module& module, const char* name, torch::IntArrayRef shape,
                    const WeightOptions& options) {
    auto values = torch::empty(shape, torch::TensorOptions().device(options.device).dtype(options.dtype));
    if (options.initialize && !values.is_meta()) values.zero_();
    return module.register_parameter(name, values);
}

/// lin1, gelu, lin2.
class SamMlpImpl : public torch::nn::Module {
public:
    SamMlpImpl(std::int64_t width, std::int64_t inner, const WeightOptions& options) {
        lin1_ = register_module("lin1", Linear(LinearImpl::Shape{width, inner}, options));
        lin2_ = register_module("lin2", Linear(LinearImpl::Shape{inner, width}, options));
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        return lin2_->forward(torch::gelu(lin1_->forward(x)));
    }

private:
    Linear lin1_{nullptr}, lin2_{nullptr};
};
TORCH_MODULE(SamMlp);

/// Self-attention in a square of tokens with a learned bias for distances, one table per axis. The bias is
/// multiplied with the unscaled query.
class SamAttentionImpl : public torch::nn::Module {
public:
    SamAttentionImpl(std::int64_t width, std::int64_t heads, std::int64_t side, const WeightOptions& options)
        : heads_(heads), side_(side) {
        qkv_ = register_module("qkv", Linear(LinearImpl::Shape{width, 3 * width}, options));
        proj_ = register_module("proj", Linear(LinearImpl::Shape{width, width}, options));
        rows_ = table(*this, "rel_pos_h", {2 * side - 1, width / heads}, options);
        columns_ = table(*this, "rel_pos_w", {2 * side - 1, width / heads}, options);
    }

    /// [B,side,side,C].
    torch::Tensor forward(const torch::Tensor& x) const {
        const auto batch = x.size(0), tokens = side_ * side_, width = x.size(3), depth = width / heads_;
        const auto qkv = qkv_->forward(x)
                             .view({batch, tokens, 3, heads_, depth})
                             .permute({2, 0, 3, 1, 4})
                             .reshape({3, batch * heads_, tokens, depth});
        const auto row_table = by_distance(rows_), column_table = by_distance(columns_);
        auto output = torch::empty({batch * heads_, tokens, depth}, x.options());
        thread_use().flop += 4.0 * static_cast<double>(batch * heads_ * tokens * tokens * depth);
        // A few heads at a time: all scores of a whole picture at once would be 800 MB.
        constexpr std::int64_t most_scores = std::int64_t{1} << 24;
        const auto together = std::max<std::int64_t>(1, most_scores / (tokens * tokens));
        for (std::int64_t first = 0; first < batch * heads_; first += together) {
            const auto count = std::min(together, batch * heads_ - first);
            const auto q = qkv[0].narrow(0, first, count), k = qkv[1].narrow(0, first, count),
                       v = qkv[2].narrow(0, first, count);
            const auto grid = q.reshape({count, side_, side_, depth});
            const auto by_row = torch::einsum("bhwc,hkc->bhwk", {grid, row_table}).unsqueeze(-1);
            const auto by_column = torch::einsum("bhwc,wkc->bhwk", {grid, column_table}).unsqueeze(-2);
            auto scores = torch::bmm(q * (1.0 / std::sqrt(static_cast<double>(depth))), k.transpose(1, 2));
            scores = scores.view({count, side_, side_, side_, side_})
                         .add_(by_row)
                         .add_(by_column)
                         .view({count, tokens, tokens});
            output.narrow(0, first, count).copy_(torch::bmm(torch::softmax(scores, -1), v));
        }
        const auto merged = output.view({batch, heads_, side_, side_, depth})
                                .permute({0, 2, 3, 1, 4})
                                .reshape({batch, side_, side_, width});
        return proj_->forward(merged);
    }

private:
    /// [side (query), side (key), depth]: the row of the table for their distance.
    torch::Tensor by_distance(const torch::Tensor& distances) const {
        const auto places =
            torch::arange(side_, torch::TensorOptions().dtype(torch::kInt64).device(distances.device()));
        return distances.index({places.unsqueeze(1) - places.unsqueeze(0) + (side_ - 1)});
    }

    std::int64_t heads_, side_;
    Linear qkv_{nullptr}, proj_{nullptr};
    torch::Tensor rows_, columns_;
};
TORCH_MODULE(SamAttention);

class SamBlockImpl : public torch::nn::Module {
public:
    SamBlockImpl(const SamVitShape& shape, std::int64_t window, const WeightOptions& options)
        : side_(shape.side), window_(window) {
        norm1_ = register_module("norm1", LayerNorm(shape.width, EncoderNormEps, options));
        norm2_ = register_module("norm2", LayerNorm(shape.width, EncoderNormEps, options));
        attention_ = register_module("attn", SamAttention(shape.width, shape.heads, window, options));
        mlp_ = register_module("mlp", SamMlp(shape.width, shape.inner, options));
    }
    torch::Tensor forward(const torch::Tensor& x) const {
        auto seen = norm1_->forward(x);
        if (window_ == side_) seen = attention_->forward(seen);
        else seen = from_windows(attention_->forward(to_windows(seen, window_)), window_, side_, side_);
        const auto summed = x + seen;
        return summed + mlp_->forward(norm2_->forward(summed));
    }

private:
    std::int64_t side_, window_;
    LayerNorm norm1_{nullptr}, norm2_{nullptr};
    SamAttention attention_{nullptr};
    SamMlp mlp_{nullptr};
};
TORCH_MODULE(SamBlock);

class SamVitImpl final : public SamImageEncoderImpl {
public:
    SamVitImpl(const SamVitShape& shape, const WeightOptions& options) : patch_(shape.patch) {
        auto patches = std::make_shared<torch::nn::Module>();
        const Conv2dImpl::Shape projection{3, shape.width, shape.patch, shape.patch, 0};
        projection_ = patches->register_module("proj", Conv2d(projection, options));
        register_module("patch_embed", patches);
        positions_ = table(*this, "pos_embed", {1, shape.side, shape.side, shape.width}, options);
        for (const auto window : shape.windows) blocks_.push_back(SamBlock(shape, window, options));
        register_list(*this, "blocks", blocks_);
        neck_ = register_module("neck", SamNeck(shape.width, shape.out, options));
    }

    torch::Tensor forward(const torch::Tensor& pixels, SamTrace* trace) const override {
        const auto note = [&](const std::string& name, const torch::Tensor& x) {
            if (trace != nullptr) trace->emplace_back(name, x);
        };
        auto x = projection_->forward(pixels).permute({0, 2, 3, 1}) + positions_;
        note("enc.patch_plus_pos", x);
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            x = blocks_[i]->forward(x);
            note("enc.block." + std::to_string(i), x);
        }
        return neck_->forward(x.permute({0, 3, 1, 2}).contiguous(), trace);
    }

private:
    std::int64_t patch_;
    Conv2d projection_{nullptr};
    torch::Tensor positions_;
    std::vector<SamBlock> blocks_;
    SamNeck neck_{nullptr};
};

}  // namespace

ChannelNormImpl::ChannelNormImpl(std::int64_t channels, const WeightOptions& options) {
    weight_ = table(*this, "weight", {channels}, options);
    bias_ = table(*this, "bias", {channels}, options);
    const torch::NoGradGuard no_grad;
    if (options.initialize && !weight_.is_meta()) weight_.fill_(1.0);
}

torch::Tensor ChannelNormImpl::forward(const torch::Tensor& x) const {
    const auto mean = x.mean(1, true), centred = x - mean;
    const auto deviation = torch::sqrt(centred.square().mean(1, true) + EncoderNormEps);
    return centred / deviation * weight_.view({1, -1, 1, 1}) + bias_.view({1, -1, 1, 1});
}

SamNeckImpl::SamNeckImpl(std::int64_t in, std::int64_t out, const WeightOptions& options) {
    reduce_ = register_module("0", Conv2d(Conv2dImpl::Shape{in, out, 1, 1, 0, false}, options));
    first_ = register_module("1", ChannelNorm(out, options));
    refine_ = register_module("2", Conv2d(Conv2dImpl::Shape{out, out, 3, 1, 1, false}, options));
    second_ = register_module("3", ChannelNorm(out, options));
}

torch::Tensor SamNeckImpl::forward(torch::Tensor x, SamTrace* trace) const {
    const auto note = [&](const char* name) {
        if (trace != nullptr) trace->emplace_back(name, x);
    };
    x = reduce_->forward(x), note("enc.neck.0");
    x = first_->forward(x), note("enc.neck.1");
    x = refine_->forward(x), note("enc.neck.2");
    x = second_->forward(x), note("enc.neck.3");
    return x;
}

torch::Tensor to_windows(const torch::Tensor& x, std::int64_t window) {
    const auto batch = x.size(0), height = x.size(1), width = x.size(2), channels = x.size(3);
    const auto below = (window - height % window) % window, right = (window - width % window) % window;
    const auto padded = torch::constant_pad_nd(x, {0, 0, 0, right, 0, below});
    const auto rows = (height + below) / window, columns = (width + right) / window;
    return padded.view({batch, rows, window, columns, window, channels})
        .permute({0, 1, 3, 2, 4, 5})
        .reshape({-1, window, window, channels});
}

torch::Tensor from_windows(const torch::Tensor& windows, std::int64_t window, std::int64_t height,
                           std::int64_t width) {
    const auto rows = (height + window - 1) / window, columns = (width + window - 1) / window,
               channels = windows.size(3);
    const auto whole = windows.view({-1, rows, columns, window, window, channels})
                           .permute({0, 1, 3, 2, 4, 5})
                           .reshape({-1, rows * window, columns * window, channels});
    return whole.narrow(1, 0, height).narrow(2, 0, width);
}

std::shared_ptr<SamImageEncoderImpl> make_sam_vit(const SamVitShape& shape, const WeightOptions& options) {
    return std::make_shared<SamVitImpl>(shape, options);
}

}  // namespace gse::neural
