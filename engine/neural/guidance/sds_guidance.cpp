// Score distillation: render -> VAE encoder -> noise -> UNet twice -> gradient back through the encoder.
#include "engine/neural/guidance/sds_guidance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/torch_errors.h"

namespace gse::neural {
namespace {

/// Gradient clamped and divided by the number of latent values: mean-reduced (METHOD.md, Score distillation).
torch::Tensor reduced(const torch::Tensor& gradient, const SdsParameters& parameters) {
    auto result = parameters.clamp > 0 ? gradient.clamp(-parameters.clamp, parameters.clamp) : gradient;
    return result * (parameters.weight / static_cast<double>(gradient.numel()));
}

}  // namespace

std::int64_t draw_timestep(const SdsParameters& parameters, double progress, std::int64_t steps,
                           Random& random) {
    const double total = static_cast<double>(steps);
    const double high = parameters.t_max_start +
                        (parameters.t_max_end - parameters.t_max_start) * std::clamp(progress, 0.0, 1.0);
    const auto lowest = std::clamp<std::int64_t>(std::llround(parameters.t_min * total), 0, steps - 1);
    const auto highest = std::clamp<std::int64_t>(std::llround(high * total), lowest, steps - 1);
    return lowest + static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(highest - lowest + 1)));
}

SdsGuidance::SdsGuidance(std::shared_ptr<const ModelBundle> bundle, std::string prompt,
                         SdsParameters parameters)
    : bundle_(std::move(bundle)), prompt_(std::move(prompt)), parameters_(std::move(parameters)) {}

const torch::Tensor& SdsGuidance::context_for(const std::string& prompt, const std::string& view_words) {
    const auto sentence = parameters_.view_words ? with_view_words(prompt, view_words) : prompt;
    const auto found = contexts_.find(sentence);
    if (found != contexts_.end()) return found->second;
    return contexts_.emplace(sentence, bundle_->encode_prompts({parameters_.negative_prompt, sentence}))
        .first->second;
}

const torch::Tensor& SdsGuidance::original_latents(const edit::GuidanceInput& input) {
    const torch::NoGradGuard no_grad;
    auto& mean = originals_[input.view_index];
    if (!mean.defined()) {
        const auto image = to_tensor(*input.original, bundle_->device).clamp(0, 1);
        mean = image_to_latents(*bundle_, resize_square(image, bundle_->image_size()));
    }
    return mean;
}

torch::Tensor SdsGuidance::pull_on_original(const edit::GuidanceInput& input, const torch::Tensor& deviation,
                                            SdsStep step) {
    const torch::NoGradGuard no_grad;
    step.context = context_for(parameters_.before_prompt, input.view_words);
    return sds_gradient(*bundle_, original_latents(input) + deviation, step).gradient;
}

edit::GuidanceOutput SdsGuidance::evaluate(const edit::GuidanceInput& input) {
    return guard_torch("the guidance", [&] {
        Random random(input.seed);
        const double progress = static_cast<double>(input.iteration) / std::max(1, input.iteration_count - 1);
        const auto t = draw_timestep(parameters_, progress, bundle_->schedule.steps(), random);

        const torch::AutoGradMode recorded(true);
        auto image = to_tensor(input.rendered, bundle_->device).requires_grad_(true);
        const auto moments =
            bundle_->vae->encode_moments(resize_square(image, bundle_->image_size()) * 2 - 1);
        auto z = moments.mean;
        if (parameters_.sample_posterior)
            z = moments.sample(seeded_noise(z.sizes(), random.next()).to(z.device()));
        const auto latents = z * bundle_->scaling_factor();
        const auto noise = seeded_noise(latents.sizes(), random.next()).to(latents.device());
        SdsStep step{noise, t, parameters_.guidance_scale, context_for(prompt_, input.view_words)};
        step.image_guidance_scale = parameters_.image_guidance_scale;
        if (takes_picture(bundle_->unet->config()))
            step.picture = input.original != nullptr ? original_latents(input) / bundle_->scaling_factor()
                                                     : moments.mean.detach();
        auto result = sds_gradient(*bundle_, latents, step);
        if (input.original != nullptr && takes_difference()) {
            const auto deviation = latents.detach() - moments.mean.detach() * bundle_->scaling_factor();
            result.gradient = result.gradient - parameters_.delta * pull_on_original(input, deviation, step);
        }
        edit::GuidanceOutput output;
        output.scalars["timestep"] = static_cast<double>(t);
        if (!torch::isfinite(result.gradient)
                 .all()
                 .item<bool>()) {  // before the clamp, which would hide an infinity
            output.gradient = Image(input.rendered.width, input.rendered.height, 3,
                                    std::numeric_limits<float>::quiet_NaN());
            return output;
        }
        const auto gradient =
            torch::autograd::grad({latents}, {image}, {reduced(result.gradient, parameters_)})[0];

        output.gradient = to_image(gradient);
        output.scalars["loss"] = 0.5 * result.gradient.square().mean().item<double>();
        output.scalars["latent_gradient_norm"] = result.gradient.norm().item<double>();
        output.scalars["gradient_norm"] = gradient.norm().item<double>();
        return output;
    });
}

}  // namespace gse::neural
