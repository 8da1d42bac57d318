// The KL autoencoder of Stable Diffusion (AutoencoderKL).
#pragma once

#include "engine/neural/api/config.h"
#include "engine/neural/layers/blocks.h"

namespace gse::neural {

/// group_norm, to_q, to_k, to_v, to_out.0 with one head over all channels, residual; on [B,C,H,W].
class VaeAttentionImpl : public torch::nn::Module {
public:
    VaeAttentionImpl(std::int64_t channels, std::int64_t groups, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    GroupNorm group_norm{nullptr};
    Linear to_q{nullptr}, to_k{nullptr}, to_v{nullptr}, to_out{nullptr};
};
TORCH_MODULE(VaeAttention);

/// The middle of both halves: resnet, attention, resnet.
class VaeMiddleImpl : public torch::nn::Module {
public:
    VaeMiddleImpl(std::int64_t channels, std::int64_t groups, const WeightOptions& options);
    torch::Tensor forward(torch::Tensor x) const;

private:
    std::vector<ResnetBlock> resnets;
    VaeAttention attention{nullptr};
};
TORCH_MODULE(VaeMiddle);

/// Image [B,3,H,W] to 2*latent_channels maps of 1/factor size.
class VaeEncoderImpl : public torch::nn::Module {
public:
    VaeEncoderImpl(const VaeConfig& config, const WeightOptions& options);
    /// `trace`, if given, receives the activations after conv_in, each down block and the middle (for tests).
    torch::Tensor forward(const torch::Tensor& image, std::vector<torch::Tensor>* trace = nullptr) const;

private:
    struct Level {
        std::vector<ResnetBlock> resnets;
        Downsample downsampler{nullptr};
    };
    Conv2d conv_in{nullptr}, conv_out{nullptr};
    std::vector<Level> levels_;
    VaeMiddle mid_block{nullptr};
    GroupNorm conv_norm_out{nullptr};
};
TORCH_MODULE(VaeEncoder);

/// Latent [B,4,h,w] to image.
class VaeDecoderImpl : public torch::nn::Module {
public:
    VaeDecoderImpl(const VaeConfig& config, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& z) const;

private:
    struct Level {
        std::vector<ResnetBlock> resnets;
        Upsample upsampler{nullptr};
    };
    Conv2d conv_in{nullptr}, conv_out{nullptr};
    std::vector<Level> levels_;
    VaeMiddle mid_block{nullptr};
    GroupNorm conv_norm_out{nullptr};
};
TORCH_MODULE(VaeDecoder);

/// Mean and logarithm of the variance of the latent, both [B,latent_channels,h,w].
struct VaeMoments {
    torch::Tensor mean, logvar;
    /// mean + std * eps.
    torch::Tensor sample(const torch::Tensor& eps) const { return mean + (logvar * 0.5).exp() * eps; }
};

/// Images are in [-1,1]. Latents here are unscaled: the UNet sees z * scaling_factor.
class AutoencoderKlImpl : public torch::nn::Module {
public:
    explicit AutoencoderKlImpl(const VaeConfig& config, const WeightOptions& options = {});
    VaeMoments encode_moments(const torch::Tensor& image) const;  // logvar clamped to [-30, 20]
    torch::Tensor decode(const torch::Tensor& z) const;
    const VaeConfig& config() const { return config_; }
    const VaeEncoder& encoder_half() const { return encoder; }

private:
    VaeConfig config_;
    VaeEncoder encoder{nullptr};
    VaeDecoder decoder{nullptr};
    Linear quant_conv{nullptr}, post_quant_conv{nullptr};
};
TORCH_MODULE(AutoencoderKl);

}  // namespace gse::neural
