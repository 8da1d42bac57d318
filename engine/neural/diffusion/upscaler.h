// Decoder to pictures of four times the model's size: a residual network on the VAE's picture and its
// latents. Blocks are those of EDSR (Lim et al. 2017), enlargements sub-pixel convolutions (Shi et al. 2016).
#pragma once

#include <filesystem>
#include <vector>

#include "engine/neural/api/config.h"
#include "engine/neural/layers/layers.h"

namespace gse::neural {

/// Pixels of a side per pixel of the VAE's picture.
inline constexpr std::int64_t UpscaleFactor = 4;

/// config.json of the folder of an upscaler.
struct UpscalerConfig {
    std::int64_t latent_channels = 4;
    std::int64_t width = 40;  // channels at the VAE's size; a multiple of 4
    std::int64_t blocks = 6;

    /// Throws Error (Model, Malformed) naming the key that is wrong.
    static UpscalerConfig from_json(const Json& json, const std::filesystem::path& path);
    Json to_json() const;
};

/// conv, SiLU, conv, plus the input.
class UpscalerBlockImpl : public torch::nn::Module {
public:
    UpscalerBlockImpl(std::int64_t width, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    Conv2d first{nullptr}, second{nullptr};
};
TORCH_MODULE(UpscalerBlock);

/// Blocks at the VAE's size, two enlargements by sub-pixel convolutions, and the enlarged picture added. Its
/// last layer begins at zero: an untrained one enlarges.
class UpscalerImpl : public torch::nn::Module {
public:
    explicit UpscalerImpl(const UpscalerConfig& config, const WeightOptions& options = {});
    /// `picture` [B,3,S,S] in [-1,1] as the VAE decodes it, `latents` [B,C,h,w] as the UNet sees them.
    /// Returns [B,3,4S,4S] in about [-1,1].
    torch::Tensor forward(const torch::Tensor& picture, const torch::Tensor& latents) const;
    const UpscalerConfig& config() const { return config_; }

private:
    UpscalerConfig config_;
    Conv2d conv_in{nullptr}, grow_1{nullptr}, grow_2{nullptr}, conv_out{nullptr};
    std::vector<UpscalerBlock> blocks_;
};
TORCH_MODULE(Upscaler);

/// Frozen, from a folder with config.json and model.safetensors. Throws Error (NotFound, Malformed, Model)
/// with one sentence.
Upscaler load_upscaler(const std::filesystem::path& folder, const torch::Device& device);

}  // namespace gse::neural
