// Text to image, image to image and score distillation on a loaded model; tensors in, tensors out.
#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "engine/base/random.h"
#include "engine/neural/diffusion/conditioning.h"
#include "engine/neural/diffusion/model_bundle.h"

namespace gse::neural {

/// Pictures whose latents are kept: 64 KB each of one of 512 pixels.
inline constexpr std::size_t MostLatents = 256;

/// One denoising run; the rows of a UNet call are as Conditioning says.
struct DenoiseJob {
    Sampler* sampler = nullptr;
    std::int64_t first = 0;             // first step done
    double guidance_scale = 7.5;        // 1 = only the positive prompt is run
    torch::Tensor context;              // [2,T,D] negative, positive
    torch::Tensor picture;              // [1,C,h,w] of a model that takes one; see picture_latents()
    double image_guidance_scale = 1.5;  // of such a model
    std::uint64_t seed = 0;             // of samplers that need fresh noise, unless `noise` gives it
    std::function<torch::Tensor(std::int64_t step)> noise;
    AttentionCapture* capture = nullptr;
    std::function<void(std::int64_t step, const torch::Tensor& latents)> after_step;
    const JobControl* control = nullptr;  // Cancelled is thrown on a stop request
};

/// Standard normal tensor on the CPU, the same on every machine.
torch::Tensor seeded_noise(torch::IntArrayRef shape, std::uint64_t seed);

/// Walks `latents` [1,C,h,w] to the clean sample, without a graph.
torch::Tensor denoise(const ModelBundle& bundle, torch::Tensor latents, const DenoiseJob& job);

/// Sampler and guidance of a kind of model.
SamplerKind sampler_of(BundleKind kind);

/// Choice of autoencoder: the VAE, or the tiny one where the model has it.
enum class Codec { Full, Quick };

/// Images are [B,3,H,W] in [0,1]; latents are scaled (what the UNet sees). Encoding takes the posterior's
/// mean.
torch::Tensor image_to_latents(const ModelBundle& bundle, const torch::Tensor& image,
                               Codec codec = Codec::Full);
torch::Tensor latents_to_image(const ModelBundle& bundle, const torch::Tensor& latents,
                               Codec codec = Codec::Full);
/// `image` of these latents, lifted by the model's upscaler to UpscaleFactor times its size. Needs an
/// upscaler.
torch::Tensor upscaled(const ModelBundle& bundle, const torch::Tensor& image, const torch::Tensor& latents);
/// Latents of a picture that conditions the model: the mean, not scaled. Undefined for models that take no
/// picture.
torch::Tensor picture_latents(const ModelBundle& bundle, const torch::Tensor& image);

/// Score distillation on scaled latents.
struct SdsStep {
    torch::Tensor noise;  // [1,C,h,w]
    std::int64_t timestep = 0;
    double guidance_scale = 7.5;
    torch::Tensor context;              // [2,T,D] negative, positive
    torch::Tensor picture = {};         // of a model that takes one
    double image_guidance_scale = 1.5;  // of such a model
};
struct SdsResult {
    torch::Tensor noisy_latents;
    torch::Tensor epsilon_negative, epsilon_positive;  // of classifier-free guidance only
    double weight = 0;                                 // 1 - alphas_cumprod[t]
    torch::Tensor gradient;                            // weight * (guided epsilon - noise), not reduced
};
/// Without a graph: the gradient is meant to be injected at `latents`.
SdsResult sds_gradient(const ModelBundle& bundle, const torch::Tensor& latents, const SdsStep& step);

}  // namespace gse::neural
