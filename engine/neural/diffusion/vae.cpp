// KL autoencoder.
#include "engine/neural/diffusion/vae.h"
#include "engine/neural/api/network_use.h"

namespace gse::neural {
namespace {

constexpr double VaeNormEps = 1e-6;  // every GroupNorm of the VAE
constexpr double LogvarLow = -30.0, LogvarHigh = 20.0;

ResnetBlock make_resnet(std::int64_t in, std::int64_t out, std::int64_t groups,
                        const WeightOptions& options) {
    return ResnetBlock(ResnetShape{in, out, groups, VaeNormEps, 0}, options);
}

torch::Tensor pointwise(const Linear& layer, const torch::Tensor& x) {
    return tokens_to_image(layer->forward(image_to_tokens(x)), x.size(2), x.size(3));
}

}  // namespace

VaeAttentionImpl::VaeAttentionImpl(std::int64_t channels, std::int64_t groups, const WeightOptions& options) {
    const LinearImpl::Shape square{channels, channels};
    group_norm = register_module("group_norm", GroupNorm(channels, groups, VaeNormEps, options));
    to_q = register_module("to_q", Linear(square, options));
    to_k = register_module("to_k", Linear(square, options));
    to_v = register_module("to_v", Linear(square, options));
    to_out = register_list(*this, "to_out", std::vector{Linear(square, options)})[0];
}

torch::Tensor VaeAttentionImpl::forward(const torch::Tensor& x) const {
    const auto tokens = image_to_tokens(group_norm->forward(x));
    const auto result = attend(to_q->forward(tokens), to_k->forward(tokens), to_v->forward(tokens), {});
    return x + tokens_to_image(to_out->forward(result.output), x.size(2), x.size(3));
}

VaeMiddleImpl::VaeMiddleImpl(std::int64_t channels, std::int64_t groups, const WeightOptions& options) {
    resnets = register_list(*this, "resnets",
                            std::vector{make_resnet(channels, channels, groups, options),
                                        make_resnet(channels, channels, groups, options)});
    attention = register_list(*this, "attentions", std::vector{VaeAttention(channels, groups, options)})[0];
}

torch::Tensor VaeMiddleImpl::forward(torch::Tensor x) const {
    x = attention->forward(resnets[0]->forward(x, {}));
    return resnets[1]->forward(x, {});
}

VaeEncoderImpl::VaeEncoderImpl(const VaeConfig& config, const WeightOptions& options) {
    const auto& widths = config.block_out_channels;
    const auto groups = config.norm_num_groups;
    conv_in = register_module("conv_in", Conv2d(Conv2dImpl::Shape{config.in_channels, widths[0]}, options));
    torch::nn::ModuleList blocks;
    auto channels = widths[0];
    for (std::size_t i = 0; i < widths.size(); ++i) {
        auto block = std::make_shared<torch::nn::Module>();
        Level level;
        for (std::int64_t j = 0; j < config.layers_per_block; ++j) {
            level.resnets.push_back(make_resnet(channels, widths[i], groups, options));
            channels = widths[i];
        }
        register_list(*block, "resnets", level.resnets);
        if (i + 1 < widths.size()) {
            level.downsampler = Downsample(channels, true, 0, options);
            register_list(*block, "downsamplers", std::vector{level.downsampler});
        }
        blocks->push_back(block);
        levels_.push_back(std::move(level));
    }
    register_module("down_blocks", blocks);
    mid_block = register_module("mid_block", VaeMiddle(channels, groups, options));
    conv_norm_out = register_module("conv_norm_out", GroupNorm(channels, groups, VaeNormEps, options));
    conv_out =
        register_module("conv_out", Conv2d(Conv2dImpl::Shape{channels, 2 * config.latent_channels}, options));
}

torch::Tensor VaeEncoderImpl::forward(const torch::Tensor& image, std::vector<torch::Tensor>* trace) const {
    const auto note = [&](const torch::Tensor& x) {
        if (trace != nullptr) trace->push_back(x);
    };
    auto x = conv_in->forward(image.contiguous(torch::MemoryFormat::ChannelsLast));
    note(x);
    for (const auto& level : levels_) {
        for (const auto& resnet : level.resnets) x = resnet->forward(x, {});
        if (!level.downsampler.is_empty()) x = level.downsampler->forward(x);
        note(x);
    }
    x = mid_block->forward(x);
    note(x);
    return conv_out->forward(conv_norm_out->forward_silu(x));
}

VaeDecoderImpl::VaeDecoderImpl(const VaeConfig& config, const WeightOptions& options) {
    const std::vector<std::int64_t> widths(config.block_out_channels.rbegin(),
                                           config.block_out_channels.rend());
    const auto groups = config.norm_num_groups;
    conv_in =
        register_module("conv_in", Conv2d(Conv2dImpl::Shape{config.latent_channels, widths[0]}, options));
    mid_block = register_module("mid_block", VaeMiddle(widths[0], groups, options));
    torch::nn::ModuleList blocks;
    auto channels = widths[0];
    for (std::size_t i = 0; i < widths.size(); ++i) {
        auto block = std::make_shared<torch::nn::Module>();
        Level level;
        for (std::int64_t j = 0; j <= config.layers_per_block; ++j) {
            level.resnets.push_back(make_resnet(channels, widths[i], groups, options));
            channels = widths[i];
        }
        register_list(*block, "resnets", level.resnets);
        if (i + 1 < widths.size()) {
            level.upsampler = Upsample(channels, options);
            register_list(*block, "upsamplers", std::vector{level.upsampler});
        }
        blocks->push_back(block);
        levels_.push_back(std::move(level));
    }
    register_module("up_blocks", blocks);
    conv_norm_out = register_module("conv_norm_out", GroupNorm(channels, groups, VaeNormEps, options));
    conv_out = register_module("conv_out", Conv2d(Conv2dImpl::Shape{channels, config.out_channels}, options));
}

torch::Tensor VaeDecoderImpl::forward(const torch::Tensor& z) const {
    auto x = mid_block->forward(conv_in->forward(z.contiguous(torch::MemoryFormat::ChannelsLast)));
    for (const auto& level : levels_) {
        for (const auto& resnet : level.resnets) x = resnet->forward(x, {});
        if (!level.upsampler.is_empty()) x = level.upsampler->forward(x, x.size(2) * 2, x.size(3) * 2);
    }
    return conv_out->forward(conv_norm_out->forward_silu(x));
}

AutoencoderKlImpl::AutoencoderKlImpl(const VaeConfig& config, const WeightOptions& options)
    : config_(config) {
    const auto latent = config_.latent_channels;
    encoder = register_module("encoder", VaeEncoder(config_, options));
    decoder = register_module("decoder", VaeDecoder(config_, options));
    quant_conv =
        register_module("quant_conv", Linear(LinearImpl::Shape{2 * latent, 2 * latent, true, true}, options));
    post_quant_conv =
        register_module("post_quant_conv", Linear(LinearImpl::Shape{latent, latent, true, true}, options));
}

VaeMoments AutoencoderKlImpl::encode_moments(const torch::Tensor& image) const {
    thread_use().encoder += static_cast<std::uint64_t>(image.size(0));
    const auto halves = pointwise(quant_conv, encoder->forward(image)).chunk(2, 1);
    return {halves[0], halves[1].clamp(LogvarLow, LogvarHigh)};
}

torch::Tensor AutoencoderKlImpl::decode(const torch::Tensor& z) const {
    thread_use().decoder += static_cast<std::uint64_t>(z.size(0));
    return decoder->forward(pointwise(post_quant_conv, z));
}

}  // namespace gse::neural
