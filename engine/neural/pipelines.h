// Text to image, image to image and score distillation on a loaded model; tensors in, tensors out.
#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "engine/base/random.h"
#include "engine/neural/model_bundle.h"

namespace gse::neural {

/// One denoising run. The UNet batch is [negative; positive] when guidance is on.
struct DenoiseJob {
    Sampler* sampler = nullptr;
    std::int64_t first = 0;       // first step done
    double guidance_scale = 7.5;  // 1 = only the positive prompt is run
    torch::Tensor context;        // [2,T,D] negative, positive
    std::uint64_t seed = 0;       // of samplers that need fresh noise
    AttentionCapture* capture = nullptr;
    std::function<void(std::int64_t step, const torch::Tensor& latents)> after_step;
    const JobControl* control = nullptr;  // Cancelled is thrown on a stop request
};

/// Standard normal tensor on the CPU, the same on every machine.
torch::Tensor seeded_noise(torch::IntArrayRef shape, std::uint64_t seed);

/// negative + scale (positive - negative), of a batch [negative; positive].
torch::Tensor guided(const torch::Tensor& output, double scale);

/// Walks `latents` [1,C,h,w] to the clean sample, without a graph.
torch::Tensor denoise(const ModelBundle& bundle, torch::Tensor latents, const DenoiseJob& job);

/// Images are [1,3,H,W] in [0,1]; latents are scaled (what the UNet sees).
torch::Tensor image_to_latents(const ModelBundle& bundle, const torch::Tensor& image);  // posterior mean
torch::Tensor latents_to_image(const ModelBundle& bundle, const torch::Tensor& latents);

/// Score distillation on scaled latents.
struct SdsStep {
    torch::Tensor noise;  // [1,C,h,w]
    std::int64_t timestep = 0;
    double guidance_scale = 7.5;
    torch::Tensor context;  // [2,T,D] negative, positive
};
struct SdsResult {
    torch::Tensor noisy_latents;
    torch::Tensor epsilon_negative, epsilon_positive;
    double weight = 0;       // 1 - alphas_cumprod[t]
    torch::Tensor gradient;  // weight * (guided epsilon - noise), not reduced
};
/// Without a graph: the gradient is meant to be injected at `latents`.
SdsResult sds_gradient(const ModelBundle& bundle, const torch::Tensor& latents, const SdsStep& step);

}  // namespace gse::neural
