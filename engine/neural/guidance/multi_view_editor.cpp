// Encode, noise, denoise inside the masks, decode the difference.
#include "engine/neural/guidance/multi_view_editor.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/edit/interfaces/view_section.h"
#include "engine/edit/optimise/surface_noise.h"
#include "engine/edit/search/front_reading.h"
#include "engine/neural/diffusion/scene_views.h"
#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/layers/buffer_cache.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/parallel_for_batches.h"
#include "engine/neural/layers/torch_errors.h"

namespace gse::neural {
namespace {

// Pixels of a batch of views: more would not fit with large models.
constexpr std::int64_t PixelsAtOnce = 8 * 64 * 64;
// Noise levels that a Turbo model was trained at (Sauer et al. 2023, section 4)
constexpr std::int64_t TurboLevels = 4;
constexpr std::uint64_t FreshNoiseStream = 1;  // of a round's seed: noise between the steps
/// Noise level above which an LCM's picture has little to do with the render. The decoder's loss on the
/// render says nothing about it then (METHOD.md, Few-step models).
constexpr double LcmPlainDecode = 0.9;

/// Share of each latent cell that may change, [1,1,h,w]; grown by one cell, but for what is drawn anew: its
/// surroundings are not its.
torch::Tensor latent_mask(const Mask& mask, std::int64_t cells, const torch::Device& device, bool anew) {
    Image image(mask.width, mask.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) image.data[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
    const auto small = resize_square(to_tensor(image, device), cells);
    return anew ? small : torch::max_pool2d(small, 3, 1, 1);
}

/// [K,CameraFeatures].
torch::Tensor cameras_of(const std::vector<edit::EditView>& views) {
    auto cameras = torch::empty({static_cast<std::int64_t>(views.size()), CameraFeatures});
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto features = camera_features(views[v].azimuth, views[v].elevation);
        std::copy(features.begin(), features.end(), cameras[static_cast<std::int64_t>(v)].data_ptr<float>());
    }
    return cameras;
}

}  // namespace

std::vector<std::int64_t> redraw_timesteps(double strength, int steps, std::int64_t total) {
    std::vector<std::int64_t> timesteps;
    for (int i = 0; i < steps; ++i) {
        const double level = strength * (steps - i) / steps;
        const auto t =
            std::clamp<std::int64_t>(std::llround(level * static_cast<double>(total)) - 1, 0, total - 1);
        if (timesteps.empty() || t < timesteps.back()) timesteps.push_back(t);
    }
    return timesteps;
}

std::vector<std::int64_t> redraw_levels(BundleKind kind, const NoiseSchedule& schedule, double strength,
                                        int steps) {
    const double total = static_cast<double>(schedule.steps());
    std::vector<std::int64_t> levels;
    const auto take = [&](const std::vector<double>& timesteps) {
        for (const double t : timesteps) levels.push_back(static_cast<std::int64_t>(t));
        return levels;
    };
    if (kind == BundleKind::Lcm || kind == BundleKind::Tcd) {
        const double known = static_cast<double>(schedule.config().original_inference_steps);
        const double reached = std::clamp(strength, 1 / known, 1.0);
        const auto count = std::min<std::int64_t>(steps, static_cast<std::int64_t>(known * reached));
        return take(
            make_sampler(SamplerKind::Lcm, schedule, std::max<std::int64_t>(count, 1), {.strength = reached})
                ->timesteps());
    }
    if (kind != BundleKind::Turbo) return redraw_timesteps(strength, steps, schedule.steps());
    const double share = std::clamp(strength, 1 / total, 1.0);
    const auto grid = std::min<std::int64_t>(
        schedule.steps(),
        std::max<std::int64_t>(TurboLevels, static_cast<std::int64_t>(std::ceil(steps / share))));
    auto config = schedule.config();
    config.timestep_spacing = "trailing";
    const auto all = make_sampler(SamplerKind::Euler, NoiseSchedule(config), grid)->timesteps();
    const std::vector<double> below(all.begin() + first_step(grid, share), all.end());
    const auto kept =
        std::max<std::size_t>(1, std::min<std::size_t>(static_cast<std::size_t>(steps), below.size()));
    if (below.empty()) return take({all.back()});
    std::vector<double> chosen;
    for (std::size_t i = 0; i < kept; ++i) chosen.push_back(below[i * below.size() / kept]);
    return take(chosen);
}

/// Everything of one round, view after view along the first dimension.
struct DiffusionViewEditor::Batch {
    torch::Tensor clean;     // [K,C,h,w] latents of the renders
    torch::Tensor original;  // the same of the unedited views
    torch::Tensor noise;
    torch::Tensor mask;      // [K,1,h,w]
    torch::Tensor contexts;  // [K,2,T,D] negative, positive
    torch::Tensor behind;   // [K,C,h,w] latents of the clean plates, else the unedited views, that what draws
                            // new things is shown; else undefined
    torch::Tensor inpaint;  // [K,2+C,h,w] the same with the mask
    torch::Tensor
        picture;  // [K,C,h,w] what a model that edits pictures is shown: the unedited views; else undefined
    torch::Tensor x;  // what the steps have made of it
    torch::Tensor
        outline;  // [K,1,s h,s w] in [0,1], where the network tells what is new in it; else undefined
};

DiffusionViewEditor::DiffusionViewEditor(std::shared_ptr<const ModelBundle> bundle, std::string prompt,
                                         SdsParameters parameters, std::shared_ptr<const ModelBundle> shapes,
                                         bool supports_appearance_editing)
    : bundle_(std::move(bundle)), shapes_(std::move(shapes)), prompt_(std::move(prompt)),
      parameters_(std::move(parameters)), restyles_(supports_appearance_editing && shapes_ != nullptr),
      apart_(is_small(bundle_->unet->config()) && bundle_->device.is_cpu()) {}

/// `exact`: for what draws new things, which knows every azimuth by the mixture of the sentences for the two
/// sides beside it.
torch::Tensor DiffusionViewEditor::contexts(const std::vector<edit::EditView>& views,
                                            const std::string& prompt, bool exact) {
    const auto encoded = [&](const std::string& sentence) {
        auto& known = encoded_[{exact, sentence}];
        if (!known.defined()) known = (exact ? shapes_ : bundle_)->encode_prompts({sentence});
        return known;
    };
    std::vector<torch::Tensor> rows;
    for (const auto& view : views) {
        // An instruction says what to do, whatever the picture shows of the thing.
        const bool says_view = parameters_.view_words && bundle_->kind != BundleKind::InstructPix2Pix;
        auto sentence = encoded(says_view && !exact ? with_view_words(prompt, view.view_words) : prompt);
        if (says_view && exact && view.azimuth) {
            const auto side = edit::side_blend(*view.azimuth);
            sentence = torch::lerp(encoded(with_view_words(prompt, side.words)),
                                   encoded(with_view_words(prompt, side.next_words)), side.share);
        }
        rows.push_back(torch::cat({encoded(parameters_.negative_prompt), sentence}));
    }
    return torch::stack(rows);
}

DiffusionViewEditor::Batch DiffusionViewEditor::prepare(const std::vector<edit::EditView>& views,
                                                        const edit::EditViewsRequest& input) {
    const auto cells = bundle_->latent_size();
    Batch batch;
    std::vector<torch::Tensor> clean(views.size()), original(views.size()), behind(views.size()), masks;
    const bool inpaints = shown_scene(input) && shapes_->unet->config().inpaint_channels > 0;
    const auto latents = [&](const Image& image) {
        return image_to_latents(
            *bundle_, resize_square(to_tensor(image, bundle_->device), bundle_->image_size()), Codec::Quick);
    };
    const auto kept = [&](const Image& image) {
        return originals_.get(key_of(image), [&] { return latents(image); });
    };
    parallel_for_batches(
        static_cast<std::int64_t>(views.size()), apart_, [&](std::int64_t begin, std::int64_t end) {
            for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
                const auto& view = views[v];
                clean[v] = latents(view.rendered);
                original[v] = view.rendered.data == view.original.data ? clean[v] : kept(view.original);
                if (inpaints)
                    behind[v] =
                        view.clean_plate.picture.data.empty() ? original[v] : kept(view.clean_plate.picture);
            }
        });
    for (const auto& view : views)
        masks.push_back(latent_mask(view.mask, cells, bundle_->device, input.anew));
    batch.clean = torch::cat(clean);
    batch.original = torch::cat(original);
    batch.noise = noise(views, input.seed);
    batch.mask = torch::cat(masks);
    if (inpaints) {
        const auto may_change = (batch.mask > 0).to(batch.mask.scalar_type());
        batch.behind = torch::cat(behind);
        batch.inpaint = inpainting(may_change, torch::ones_like(may_change), batch.behind);
    }
    // Such a model is told what to do, not what there is.
    const bool edits = takes_picture(bundle_->unet->config());
    batch.contexts =
        contexts(views, edits || input.sentence.empty() ? prompt_ : input.sentence, shown_scene(input));
    if (edits)
        batch.picture = batch.original / bundle_->scaling_factor();  // as the model is used to it: not scaled
    return batch;
}

torch::Tensor DiffusionViewEditor::noise(const std::vector<edit::EditView>& views, std::uint64_t seed) const {
    const auto cells = static_cast<int>(bundle_->latent_size());
    const auto channels = static_cast<int>(bundle_->latent_channels());
    const double voxel = edit::noise_voxel(views, cells);
    std::vector<torch::Tensor> parts;
    for (std::size_t v = 0; v < views.size(); ++v)
        parts.push_back(to_tensor(
            edit::surface_noise(views[v].depth, views[v].view.camera, cells, channels, voxel, seed, v),
            bundle_->device));
    return torch::cat(parts);
}

torch::Tensor DiffusionViewEditor::output(const UNet& unet, const torch::Tensor& x, std::int64_t timestep,
                                          const Conditioning& conditioning) const {
    const auto side = bundle_->image_size();
    const auto at_once = std::max<std::int64_t>(1, PixelsAtOnce / (side * side));
    auto result = torch::empty_like(x);
    // Whole pieces: products round differently with another number of rows.
    parallel_for_batches(
        (x.size(0) + at_once - 1) / at_once, apart_, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t first = begin * at_once; first < std::min(end * at_once, x.size(0));
                 first += at_once) {
                const auto count = std::min(at_once, x.size(0) - first);
                auto some = conditioning;
                some.context = conditioning.context.narrow(0, first, count);
                if (some.picture.defined()) some.picture = conditioning.picture.narrow(0, first, count);
                const auto t = torch::full({1}, timestep, torch::kFloat32);
                result.narrow(0, first, count).copy_(guided_output(unet, x.narrow(0, first, count), t, some));
            }
        });
    return result;
}

torch::Tensor DiffusionViewEditor::output_together(const torch::Tensor& x, std::int64_t timestep,
                                                   const Conditioning& conditioning,
                                                   const std::vector<std::vector<std::int64_t>>& groups,
                                                   torch::Tensor* outline) const {
    auto result = torch::empty_like(x);
    const auto scale = shapes_->unet->config().outline_scale;
    if (scale == 0) outline = nullptr;
    if (outline != nullptr)
        *outline = torch::empty({x.size(0), 1, scale * x.size(2), scale * x.size(3)},
                                x.options().dtype(torch::kFloat));
    const auto t = torch::full({1}, timestep, torch::kFloat32);
    parallel_for_batches(
        static_cast<std::int64_t>(groups.size()), apart_, [&](std::int64_t begin, std::int64_t end) {
            for (auto g = static_cast<std::size_t>(begin); g < static_cast<std::size_t>(end); ++g) {
                const auto rows = torch::tensor(groups[g], torch::kInt64).to(x.device());
                auto some = conditioning;
                some.context = conditioning.context.index_select(0, rows);
                some.views.together = static_cast<std::int64_t>(groups[g].size());
                some.views.cameras = conditioning.views.cameras.index_select(0, rows);
                if (some.views.inpaint.defined())
                    some.views.inpaint = conditioning.views.inpaint.index_select(0, rows);
                torch::Tensor told;
                some.views.outline = outline != nullptr ? &told : nullptr;
                result.index_copy_(0, rows, guided_output(shapes_->unet, x.index_select(0, rows), t, some));
                if (outline != nullptr) outline->index_copy_(0, rows, told.sigmoid());
            }
        });
    return result;
}

void DiffusionViewEditor::denoise(Batch& batch, const std::vector<edit::EditView>& views,
                                  const edit::EditViewsRequest& input, const JobControl& job) const {
    const auto& schedule = bundle_->schedule;
    const auto timesteps = redraw_levels(bundle_->kind, schedule, input.strength, input.steps);
    const bool shapes = shown_scene(input);
    const double scale = input.anew ? parameters_.shape_guidance_scale
                         : shapes   ? parameters_.restyle_guidance_scale
                                    : parameters_.view_guidance_scale;
    Conditioning edited{batch.contexts, scale, batch.picture, parameters_.image_guidance_scale};
    // Others hold guidance themselves, or follow a picture.
    const bool pairs = !batch.picture.defined() && row_parts(bundle_->unet->config(), edited) == 2;
    std::vector<std::optional<double>> azimuths;
    if (shapes) {
        edited.views.cameras = cameras_of(views).to(bundle_->device);
        edited.views.inpaint = batch.inpaint;
        for (const auto& view : views) azimuths.push_back(view.azimuth);
    }
    const auto predicted = [&](std::size_t step) {
        if (!shapes) return output(bundle_->unet, batch.x, timesteps[step], edited);
        // In turns with those far around the thing and with neighbours, so that every view comes to know of
        // all.
        return output_together(
            batch.x, timesteps[step], edited,
            view_groups(azimuths, shapes_->facts.shape_views, step % 2 == 0),
            input.anew && step + 1 == timesteps.size() && batch.inpaint.defined() ? &batch.outline : nullptr);
    };
    const auto roots = [&](std::int64_t t) {
        const double a = schedule.alpha_cumprod(t);
        return std::pair{std::sqrt(a), std::sqrt(1 - a)};
    };
    const auto [signal, deviation] = roots(timesteps.front());
    batch.x = signal * batch.clean + (input.anew ? deviation * input.noise : deviation) * batch.noise;
    for (std::size_t i = 0; i < timesteps.size(); ++i) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "redrawing the views was stopped");
        const auto t = torch::full({1}, timesteps[i], torch::kInt64);
        const double level = static_cast<double>(timesteps[i] + 1) / static_cast<double>(schedule.steps());
        if (pairs && level <= input.guided_until) edited.guidance_scale = 1;
        auto x0 = schedule.to_x0(predicted(i), batch.x, t);
        x0 = batch.mask * x0 +
             (1 - batch.mask) * batch.original;  // the surroundings stay, and keep the steps in place
        const auto [now, spread] = roots(timesteps[i]);
        if (i + 1 == timesteps.size()) {
            batch.x = x0;
        } else {
            const auto [next, less] = roots(timesteps[i + 1]);
            // A latent consistency model goes on from fresh noise; the others from what is left of the first.
            const bool fresh = bundle_->kind == BundleKind::Lcm;
            const auto left = fresh ? noise(views, Random::stream(input.seed, FreshNoiseStream + i).next())
                                    : (batch.x - now * x0) / spread;
            batch.x = next * x0 + less * left;
        }
        job.report("redrawing the views", static_cast<int>(i + 1), static_cast<int>(timesteps.size()));
    }
}

/// Adds the decoded change to the render: losses of autoencoder and resize cancel. A picture that is made
/// anew is taken as it is. All rounds but the last use the tiny decoder.
edit::EditedViews DiffusionViewEditor::finish(const Batch& batch, const std::vector<edit::EditView>& views,
                                              const edit::EditViewsRequest& input) const {
    const auto codec = input.round + 1 < input.rounds ? Codec::Quick : Codec::Full;
    const bool anew = input.anew || bundle_->kind == BundleKind::InstructPix2Pix ||
                      (bundle_->kind == BundleKind::Lcm && input.strength >= LcmPlainDecode);
    edit::EditedViews targets;
    targets.images.resize(views.size());
    const bool tells = input.tells_changes && batch.behind.defined() && !batch.outline.defined();
    if (tells) targets.changes.resize(views.size());
    if (batch.outline.defined()) targets.outlines.resize(views.size());
    parallel_for_batches(
        static_cast<std::int64_t>(views.size()), apart_, [&](std::int64_t begin, std::int64_t end) {
            for (auto row = begin; row < end; ++row) {
                const Image& rendered = views[static_cast<std::size_t>(row)].rendered;
                auto decoded = latents_to_image(*bundle_, batch.x.narrow(0, row, 1), codec);
                if (!anew)
                    decoded = decoded - latents_to_image(*bundle_, batch.clean.narrow(0, row, 1), codec);
                const auto enlarge = [&](const torch::Tensor& picture) {
                    return torch::upsample_bilinear2d(picture, {rendered.height, rendered.width}, false);
                };
                auto enlarged = input.anew && upscales(codec, rendered)
                                    ? resize_square(upscaled(*bundle_, decoded, batch.x.narrow(0, row, 1)),
                                                    rendered.height)
                                    : enlarge(decoded);
                if (tells) {
                    const auto change =
                        (decoded.clamp(0, 1) -
                         latents_to_image(*bundle_, batch.behind.narrow(0, row, 1), codec).clamp(0, 1))
                            .abs();
                    targets.changes[static_cast<std::size_t>(row)] = to_image(enlarge(change.amax(1, true)));
                }
                if (batch.outline.defined())
                    targets.outlines[static_cast<std::size_t>(row)] =
                        to_image(enlarge(batch.outline.narrow(0, row, 1)));
                if (!anew) enlarged = to_tensor(rendered, bundle_->device) + enlarged;
                targets.images[static_cast<std::size_t>(row)] = to_image(enlarged.clamp(0, 1));
            }
        });
    double change = 0, pixels = 0;
    for (std::size_t v = 0; v < views.size(); ++v)
        for (std::size_t i = 0; i < views[v].mask.data.size(); ++i) {
            if (views[v].mask.data[i] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                change += std::abs(targets.images[v].data[i * 3 + c] - views[v].rendered.data[i * 3 + c]) / 3;
            pixels += 1;
        }
    targets.scalars["redrawn_change"] = pixels > 0 ? change / pixels : 0;  // mean over what may change
    return targets;
}

/// The network for new objects has learned close views, too.
edit::EditedViews DiffusionViewEditor::edit(const std::vector<edit::EditView>& views,
                                            const edit::EditViewsRequest& input, const JobControl& job) {
    if (!shown_scene(input)) return redraw(views, input, job);
    std::vector<edit::ViewSection> sections;
    std::vector<edit::EditView> parts;
    for (const auto& view : views) {
        sections.push_back(edit::section_around(view.mask));
        parts.push_back(edit::cut_out_section(view, sections.back()));
    }
    auto targets = redraw(parts, input, job);
    for (std::size_t v = 0; v < views.size(); ++v)
        targets.images[v] = edit::with_section(views[v].rendered, targets.images[v], sections[v]);
    for (auto* maps : {&targets.changes, &targets.outlines})
        for (std::size_t v = 0; v < maps->size(); ++v)
            (*maps)[v] = edit::with_section(Image(views[v].rendered.width, views[v].rendered.height, 1),
                                            (*maps)[v], sections[v]);
    return targets;
}

edit::EditedViews DiffusionViewEditor::redraw(const std::vector<edit::EditView>& views,
                                              const edit::EditViewsRequest& input, const JobControl& job) {
    return guard_torch("redrawing the views", [&] {
        const torch::NoGradGuard no_grad;
        Batch batch = prepare(views, input);
        denoise(batch, views, input, job);
        release_buffers();  // those of the UNet do not fit the decoder, which takes most of all
        auto targets = finish(batch, views, input);
        if (!torch::isfinite(batch.x).all().item<bool>())
            throw Error(
                ErrorCode::Model, "the model's pictures hold values that are not finite",
                "its weights are damaged, or it overflows: try another model or a lower guidance scale");
        return targets;
    });
}

}  // namespace gse::neural
