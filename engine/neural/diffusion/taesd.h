// The tiny autoencoder (TAESD, Ollin Boer Bohan; AutoencoderTiny in diffusers): 14 times cheaper than the
// VAE, for probes, rounds and previews. Its latents are the UNet's own, without another scale.
#pragma once

#include <filesystem>

#include "engine/neural/api/config.h"
#include "engine/neural/layers/layers.h"

namespace gse::neural {

/// conv, ReLU, conv, ReLU, conv; plus x; ReLU.
class TinyBlockImpl : public torch::nn::Module {
public:
    TinyBlockImpl(std::int64_t channels, const WeightOptions& options);
    torch::Tensor forward(const torch::Tensor& x) const;

private:
    Conv2d first{nullptr}, second{nullptr}, third{nullptr};
};
TORCH_MODULE(TinyBlock);

/// One half: a row of layers, named by their places in it.
class TinyHalfImpl : public torch::nn::Module {
public:
    static std::shared_ptr<TinyHalfImpl> encoder(const TinyAutoencoderConfig& config,
                                                 const WeightOptions& options);
    static std::shared_ptr<TinyHalfImpl> decoder(const TinyAutoencoderConfig& config,
                                                 const WeightOptions& options);
    torch::Tensor forward(torch::Tensor x) const;

private:
    void add_convolution(const Conv2dImpl::Shape& shape, const WeightOptions& options);
    void add_blocks(std::int64_t count, std::int64_t channels, const WeightOptions& options);
    void add_plain(std::function<torch::Tensor(const torch::Tensor&)> layer);
    void finish();

    torch::nn::ModuleList list_;
    std::vector<std::function<torch::Tensor(const torch::Tensor&)>> layers_;
};
TORCH_MODULE(TinyHalf);

/// Images are in [0,1], latents as the UNet sees them.
class TinyAutoencoderImpl : public torch::nn::Module {
public:
    explicit TinyAutoencoderImpl(const TinyAutoencoderConfig& config, const WeightOptions& options = {});
    torch::Tensor encode(const torch::Tensor& image) const;
    /// Not clamped; the latents are softly held within +-3 first.
    torch::Tensor decode(const torch::Tensor& latents) const;
    const TinyAutoencoderConfig& config() const { return config_; }
    const TinyHalf& encoder_half() const { return encoder; }
    const TinyHalf& decoder_half() const { return decoder; }

private:
    TinyAutoencoderConfig config_;
    TinyHalf encoder{nullptr}, decoder{nullptr};
};
TORCH_MODULE(TinyAutoencoder);

/// From a folder with config.json and diffusion_pytorch_model.safetensors, or with taesd_encoder.safetensors
/// and taesd_decoder.safetensors; fp32. Throws Error (NotFound, Malformed, Model).
TinyAutoencoder load_tiny_autoencoder(const std::filesystem::path& folder);

/// Tells whether load_tiny_autoencoder() would find files there.
bool has_tiny_autoencoder(const std::filesystem::path& folder);

}  // namespace gse::neural
