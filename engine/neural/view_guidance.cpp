// Encode, noise, denoise inside the masks, decode the difference.
#include "engine/neural/view_guidance.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/edit/surface_noise.h"
#include "engine/neural/attention_source.h"
#include "engine/neural/images.h"
#include "engine/neural/torch_errors.h"

namespace gse::neural {
namespace {

constexpr std::int64_t PixelsAtOnce = 8 * 64 * 64;   // of a batch of views: more would not fit with large models

/// Share of each latent cell that may change, grown by one cell: [1,1,h,w].
torch::Tensor latent_mask(const Mask& mask, std::int64_t cells, const torch::Device& device) {
    Image image(mask.width, mask.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) image.data[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
    const auto small = resize_square(to_tensor(image, device), cells);
    return torch::max_pool2d(small, 3, 1, 1);
}

}  // namespace

std::vector<std::int64_t> redraw_timesteps(double strength, int steps, std::int64_t total) {
    std::vector<std::int64_t> timesteps;
    for (int i = 0; i < steps; ++i) {
        const double level = strength * (steps - i) / steps;
        const auto t = std::clamp<std::int64_t>(std::llround(level * static_cast<double>(total)) - 1, 0, total - 1);
        if (timesteps.empty() || t < timesteps.back()) timesteps.push_back(t);
    }
    return timesteps;
}

/// Everything of one round, view after view along the first dimension.
struct DiffusionViews::Batch {
    torch::Tensor clean;      // [K,C,h,w] latents of the renders
    torch::Tensor original;   // the same of the unedited views
    torch::Tensor noise;
    torch::Tensor mask;       // [K,1,h,w]
    torch::Tensor contexts;   // [K,2,T,D] negative, positive
    torch::Tensor before;     // the same with the sentence before the edit; undefined where nothing is taken off
    torch::Tensor x;          // what the steps have made of it
};

DiffusionViews::DiffusionViews(std::shared_ptr<const ModelBundle> bundle, std::string prompt, SdsParameters parameters)
    : bundle_(std::move(bundle)), prompt_(std::move(prompt)), parameters_(std::move(parameters)) {}

torch::Tensor DiffusionViews::contexts(const std::vector<edit::RoundView>& views, const std::string& prompt) {
    const auto encoded = [&](const std::string& sentence) {
        auto& known = encoded_[sentence];
        if (!known.defined()) known = bundle_->encode_prompts({sentence});
        return known;
    };
    std::vector<torch::Tensor> rows;
    for (const auto& view : views) {
        const auto sentence = parameters_.view_words ? with_view_words(prompt, view.view_words) : prompt;
        rows.push_back(torch::cat({encoded(parameters_.negative_prompt), encoded(sentence)}));
    }
    return torch::stack(rows);
}

DiffusionViews::Batch DiffusionViews::prepare(const std::vector<edit::RoundView>& views, const edit::RoundInput& input) {
    const auto cells = bundle_->latent_size();
    const auto channels = bundle_->unet->config().in_channels;
    const double voxel = edit::noise_voxel(views, static_cast<int>(cells));
    Batch batch;
    std::vector<torch::Tensor> clean, original, noise, masks;
    const auto latents = [&](const Image& image) {
        return image_to_latents(*bundle_, resize_square(to_tensor(image, bundle_->device), bundle_->image_size()));
    };
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto& view = views[v];
        clean.push_back(latents(view.rendered));
        original.push_back(view.rendered.data == view.original.data ? clean.back() : latents(view.original));
        noise.push_back(to_tensor(edit::surface_noise(view.depth, view.view.camera, static_cast<int>(cells),
                                                         static_cast<int>(channels), voxel, input.seed, v),
                                     bundle_->device));
        masks.push_back(latent_mask(view.mask, cells, bundle_->device));
    }
    batch.clean = torch::cat(clean);
    batch.original = torch::cat(original);
    batch.noise = torch::cat(noise);
    batch.mask = torch::cat(masks);
    batch.contexts = contexts(views, prompt_);
    const auto& before = parameters_.before_prompt;
    if (!input.anew && parameters_.delta > 0 && !before.empty() && before != prompt_) batch.before = contexts(views, before);
    return batch;
}

torch::Tensor DiffusionViews::output(const torch::Tensor& x, std::int64_t timestep, const torch::Tensor& contexts,
                                      double guidance_scale) const {
    const auto side = bundle_->image_size();
    const auto at_once = std::max<std::int64_t>(1, PixelsAtOnce / (side * side));
    const bool guided_by_two = guidance_scale != 1.0;
    std::vector<torch::Tensor> parts;
    for (std::int64_t first = 0; first < x.size(0); first += at_once) {
        const auto count = std::min(at_once, x.size(0) - first);
        const auto some = x.narrow(0, first, count);
        const auto words = contexts.narrow(0, first, count);
        const auto positive = words.select(1, 1);
        const auto t = torch::full({1}, timestep, torch::kFloat32);
        parts.push_back(guided_by_two ? guided(bundle_->unet->forward(torch::cat({some, some}), t,
                                                                      torch::cat({words.select(1, 0), positive})),
                                               guidance_scale)
                                      : bundle_->unet->forward(some, t, positive));
    }
    return torch::cat(parts);
}

void DiffusionViews::denoise(Batch& batch, const edit::RoundInput& input, const JobControl& job) const {
    const auto& schedule = bundle_->schedule;
    const auto timesteps = redraw_timesteps(input.strength, input.steps, schedule.steps());
    const auto roots = [&](std::int64_t t) {
        const double a = schedule.alpha_cumprod(t);
        return std::pair{std::sqrt(a), std::sqrt(1 - a)};
    };
    const auto [signal, deviation] = roots(timesteps.front());
    batch.x = signal * batch.clean + deviation * batch.noise;
    for (std::size_t i = 0; i < timesteps.size(); ++i) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "redrawing the views was stopped");
        const auto t = torch::full({1}, timesteps[i], torch::kInt64);
        auto x0 = schedule.to_x0(output(batch.x, timesteps[i], batch.contexts, parameters_.view_guidance_scale), batch.x, t);
        if (batch.before.defined()) {   // what it would change on the unedited view anyway is taken off
            const auto [a, b] = roots(timesteps[i]);
            const auto unedited = a * batch.original + b * batch.noise;
            x0 = x0 + parameters_.delta *
                          (batch.original - schedule.to_x0(output(unedited, timesteps[i], batch.before, 1.0), unedited, t));
        }
        x0 = batch.mask * x0 + (1 - batch.mask) * batch.original;   // the surroundings stay, and keep the steps in place
        const auto [now, spread] = roots(timesteps[i]);
        if (i + 1 == timesteps.size()) {
            batch.x = x0;
        } else {
            const auto [next, less] = roots(timesteps[i + 1]);
            batch.x = next * x0 + less * ((batch.x - now * x0) / spread);
        }
        job.report("redrawing the views", static_cast<int>(i + 1), static_cast<int>(timesteps.size()));
    }
}

/// What the decoder makes of the change is added to the render: its own loss, and that of the resize, cancel. Where nothing of the
/// render is kept, its difference to what the decoder makes of it is noise: there the decoded picture counts.
edit::RoundTargets DiffusionViews::finish(const Batch& batch, const std::vector<edit::RoundView>& views, bool anew) const {
    edit::RoundTargets targets;
    double change = 0, pixels = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto row = static_cast<std::int64_t>(v);
        const Image& rendered = views[v].rendered;
        const auto enlarged = [&](const torch::Tensor& picture) {
            return torch::upsample_bilinear2d(picture, {rendered.height, rendered.width}, false);
        };
        const auto redrawn = batch.x.narrow(0, row, 1);
        if (anew) {
            targets.images.push_back(to_image(enlarged(latents_to_image(*bundle_, redrawn)).clamp(0, 1)));
        } else {
            const auto decoded = latents_to_image(*bundle_, torch::cat({redrawn, batch.clean.narrow(0, row, 1)}));
            const auto difference = decoded.narrow(0, 0, 1) - decoded.narrow(0, 1, 1);
            targets.images.push_back(to_image((to_tensor(rendered, bundle_->device) + enlarged(difference)).clamp(0, 1)));
        }
        for (std::size_t i = 0; i < views[v].mask.data.size(); ++i) {
            if (views[v].mask.data[i] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                change += std::abs(targets.images.back().data[i * 3 + c] - rendered.data[i * 3 + c]) / 3;
            pixels += 1;
        }
    }
    targets.scalars["redrawn_change"] = pixels > 0 ? change / pixels : 0;   // mean over what may change
    return targets;
}

edit::RoundTargets DiffusionViews::edit(const std::vector<edit::RoundView>& views, const edit::RoundInput& input,
                                        const JobControl& job) {
    return guard_torch("redrawing the views", [&] {
        const torch::NoGradGuard no_grad;
        Batch batch = prepare(views, input);
        denoise(batch, input, job);
        auto targets = finish(batch, views, input.anew);
        if (!torch::isfinite(batch.x).all().item<bool>())
            throw Error(ErrorCode::Model, "the model's pictures hold values that are not finite",
                        "its weights are damaged, or it overflows: try another model or a lower guidance scale");
        return targets;
    });
}

}  // namespace gse::neural
