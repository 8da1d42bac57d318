// Denoising loop, classifier-free guidance and the SDS gradient.
#include "engine/neural/diffusion/pipelines.h"

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::neural {

torch::Tensor seeded_noise(torch::IntArrayRef shape, std::uint64_t seed) {
    auto noise = torch::empty(shape, torch::kFloat32);
    Random random(seed);
    float* values = noise.data_ptr<float>();
    for (std::int64_t i = 0; i < noise.numel(); ++i) values[i] = static_cast<float>(random.normal());
    return noise;
}

torch::Tensor denoise(const ModelBundle& bundle, torch::Tensor latents, const DenoiseJob& job) {
    const torch::NoGradGuard no_grad;
    GSE_CHECK(job.sampler != nullptr);
    auto& sampler = *job.sampler;
    const Conditioning conditioning{job.context.unsqueeze(0), job.guidance_scale, job.picture,
                                    job.image_guidance_scale};
    latents = latents.to(bundle.device);
    for (std::int64_t i = job.first; i < sampler.step_count(); ++i) {
        if (job.control != nullptr && job.control->stop_requested())
            throw Error(ErrorCode::Cancelled, "sampling was stopped");
        const auto input = sampler.scale_input(latents, i);
        const auto t = torch::full({1}, sampler.timestep(i), torch::kFloat32);
        const auto output = guided_output(bundle.unet, input, t, conditioning, job.capture);
        torch::Tensor noise;
        if (job.noise) noise = job.noise(i).to(bundle.device);
        else if (sampler.needs_noise())
            noise = seeded_noise(latents.sizes(),
                                 Random::stream(job.seed, static_cast<std::uint64_t>(i) + 1).next())
                        .to(bundle.device);
        latents = sampler.step(output, latents, i, noise);
        if (job.after_step) job.after_step(i, latents);
        if (job.control != nullptr)
            job.control->report("sampling", static_cast<int>(i - job.first + 1),
                                static_cast<int>(sampler.step_count() - job.first));
    }
    return latents;
}

SamplerKind sampler_of(BundleKind kind) {
    if (kind == BundleKind::Lcm) return SamplerKind::Lcm;
    return kind == BundleKind::Tcd ? SamplerKind::Tcd : SamplerKind::Ddim;
}

torch::Tensor image_to_latents(const ModelBundle& bundle, const torch::Tensor& image, Codec codec) {
    if (codec == Codec::Quick && bundle.has_tiny()) return bundle.tiny->encode(image);
    return bundle.vae->encode_moments(image * 2 - 1).mean * bundle.scaling_factor();
}

torch::Tensor latents_to_image(const ModelBundle& bundle, const torch::Tensor& latents, Codec codec) {
    if (codec == Codec::Quick && bundle.has_tiny()) return bundle.tiny->decode(latents).clamp(0, 1);
    return (bundle.vae->decode(latents / bundle.scaling_factor()) / 2 + 0.5).clamp(0, 1);
}

torch::Tensor upscaled(const ModelBundle& bundle, const torch::Tensor& image, const torch::Tensor& latents) {
    GSE_CHECK(!bundle.upscaler.is_empty());
    return (bundle.upscaler->forward(image * 2 - 1, latents) / 2 + 0.5).clamp(0, 1);
}

torch::Tensor picture_latents(const ModelBundle& bundle, const torch::Tensor& image) {
    if (!takes_picture(bundle.unet->config())) return {};
    return bundle.vae->encode_moments(image * 2 - 1).mean;
}

SdsResult sds_gradient(const ModelBundle& bundle, const torch::Tensor& latents, const SdsStep& step) {
    const torch::NoGradGuard no_grad;
    const auto& schedule = bundle.schedule;
    const auto t = torch::full({1}, step.timestep, torch::kInt64);
    SdsResult result;
    result.noisy_latents = schedule.add_noise(latents, step.noise, t);
    result.weight = 1.0 - static_cast<double>(schedule.alpha_cumprod(step.timestep));
    const auto& config = bundle.unet->config();
    if (takes_picture(config) || config.time_cond_proj_dim > 0) {
        const Conditioning conditioning{step.context.unsqueeze(0), step.guidance_scale, step.picture,
                                        step.image_guidance_scale};
        const auto output = guided_output(bundle.unet, result.noisy_latents, t, conditioning);
        result.gradient = result.weight * (schedule.to_epsilon(output, result.noisy_latents, t) - step.noise);
        return result;
    }
    const auto input = torch::cat({result.noisy_latents, result.noisy_latents});
    const auto output = bundle.unet->forward(input, t, step.context);
    const auto epsilon = schedule.to_epsilon(output, input, t.expand({2}));
    result.epsilon_negative = epsilon.narrow(0, 0, 1);
    result.epsilon_positive = epsilon.narrow(0, 1, 1);
    result.gradient = result.weight * (guided(epsilon, step.guidance_scale) - step.noise);
    return result;
}

}  // namespace gse::neural
