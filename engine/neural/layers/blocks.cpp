// Residual block and resampling.
#include "engine/neural/layers/blocks.h"

namespace gse::neural {

ResnetBlockImpl::ResnetBlockImpl(const ResnetShape& shape, const WeightOptions& options) {
    norm1 = register_module("norm1", GroupNorm(shape.in, shape.groups, shape.eps, options));
    conv1 = register_module("conv1", Conv2d(Conv2dImpl::Shape{shape.in, shape.out}, options));
    if (shape.time_width > 0)
        time_emb_proj =
            register_module("time_emb_proj", Linear(LinearImpl::Shape{shape.time_width, shape.out}, options));
    norm2 = register_module("norm2", GroupNorm(shape.out, shape.groups, shape.eps, options));
    conv2 = register_module("conv2", Conv2d(Conv2dImpl::Shape{shape.out, shape.out}, options));
    if (shape.in != shape.out)
        conv_shortcut = register_module("conv_shortcut",
                                        Linear(LinearImpl::Shape{shape.in, shape.out, true, true}, options));
}

torch::Tensor ResnetBlockImpl::forward(const torch::Tensor& x, const torch::Tensor& time) const {
    auto h = conv1->forward(norm1->forward_silu(x));
    if (!time_emb_proj.is_empty()) h = h + time_emb_proj->forward(time).unsqueeze(-1).unsqueeze(-1);
    h = conv2->forward(norm2->forward_silu(h));
    if (conv_shortcut.is_empty()) return x + h;
    return tokens_to_image(conv_shortcut->forward(image_to_tokens(x)), x.size(2), x.size(3)) + h;
}

DownsampleImpl::DownsampleImpl(std::int64_t channels, bool right_bottom_only, std::int64_t padding,
                               const WeightOptions& options)
    : right_bottom_only_(right_bottom_only) {
    conv = register_module(
        "conv",
        Conv2d(Conv2dImpl::Shape{channels, channels, 3, 2, right_bottom_only ? 0 : padding}, options));
}

torch::Tensor DownsampleImpl::forward(const torch::Tensor& x) const {
    if (!right_bottom_only_) return conv->forward(x);
    return conv->forward(torch::constant_pad_nd(x, {0, 1, 0, 1}, 0));
}

UpsampleImpl::UpsampleImpl(std::int64_t channels, const WeightOptions& options) {
    conv = register_module("conv", Conv2d(Conv2dImpl::Shape{channels, channels}, options));
}

torch::Tensor UpsampleImpl::forward(const torch::Tensor& x, std::int64_t height, std::int64_t width) const {
    return conv->forward(torch::upsample_nearest2d(x, {height, width}));
}

}  // namespace gse::neural
