// Residual block and resampling shared by the UNet and the VAE.
#pragma once

#include "engine/neural/layers/layers.h"

namespace gse::neural {

struct ResnetShape {
    std::int64_t in = 0, out = 0;
    std::int64_t groups = 32;
    double eps = 1e-5;
    std::int64_t time_width = 0;  // 0 = no time embedding (VAE)
};

/// norm1, SiLU, conv1, + time embedding, norm2, SiLU, conv2, + (1x1) shortcut.
class ResnetBlockImpl : public torch::nn::Module {
public:
    ResnetBlockImpl(const ResnetShape& shape, const WeightOptions& options);
    /// `time` is SiLU(time embedding) [B,time_width], or undefined.
    torch::Tensor forward(const torch::Tensor& x, const torch::Tensor& time) const;

private:
    GroupNorm norm1{nullptr}, norm2{nullptr};
    Conv2d conv1{nullptr}, conv2{nullptr};
    Linear time_emb_proj{nullptr}, conv_shortcut{nullptr};
};
TORCH_MODULE(ResnetBlock);

/// 3x3 convolution with stride 2. The VAE pads right and bottom only, the UNet all around.
class DownsampleImpl : public torch::nn::Module {
public:
    DownsampleImpl(std::int64_t channels, bool right_bottom_only, std::int64_t padding,
                   const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    bool right_bottom_only_;
    Conv2d conv{nullptr};
};
TORCH_MODULE(Downsample);

/// Nearest enlargement to [height,width], then a 3x3 convolution.
class UpsampleImpl : public torch::nn::Module {
public:
    UpsampleImpl(std::int64_t channels, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x, std::int64_t height, std::int64_t width) const;

private:
    Conv2d conv{nullptr};
};
TORCH_MODULE(Upsample);

}  // namespace gse::neural
