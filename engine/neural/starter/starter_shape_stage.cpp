// Trains what draws new things: the UNet's weights, which become a LoRA beside those that look for things,
// the words for the sides of a thing, and an embedding of cameras. Views of one scene are denoised together,
// self-attention going across all of them (MVDream, Shi et al. 2023), so that they come to show one thing; in
// some groups one or two views are clean, as views that are drawn already are where others follow. Every
// caption says from where the picture was taken; between two sides the encoded sentences are mixed, as
// view-dependent prompting does (threestudio, Perp-Neg: Armandpour et al. 2023). Most groups are shown the
// scene as it was before the edit, as inpainting models are (Rombach et al. 2022), and asked which pixels
// what is new covers, as models of transparent layers tell (Zhang and Agrawala 2024). What counts of a
// picture is mostly the thing, then what may change: of a redrawn view nothing else is kept.
#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/neural/api/starter_words.h"
#include "engine/neural/diffusion/scene_views.h"
#include "engine/neural/diffusion/schedulers.h"
#include "engine/neural/layers/mixed_precision.h"
#include "engine/neural/starter/starter_inpainting.h"
#include "engine/neural/starter/starter_stages.h"

namespace gse::neural {
namespace {

constexpr int ShapeTimesteps = 1000;
// Weight of a latent cell: where nothing may change, where something may, what is added for the object and
// for an accessory, which is small.
constexpr double Kept = 0.1, Changed = 0.4, OfObject = 1, OfAccessory = 2;
constexpr int CleanTimesteps = 20;      // below it a view counts as drawn
constexpr double CleanShare = 0.25;     // of groups with such views, one or two of them
constexpr double OutlineWeight = 0.3;   // of the outlines' cross-entropy beside the noise's error
constexpr double UnknownCameras = 0.1;  // of groups that are not told from where they were taken

struct ShapeBatch {
    torch::Tensor ids;         // [2B,T] long: the sentences, then those of the next side
    torch::Tensor next_share;  // [B,1,1]
    torch::Tensor latents;     // [B,C,G,G] scaled
    torch::Tensor noise;       // [B,C,G,G]
    torch::Tensor timesteps;   // [B] long
    torch::Tensor weights;     // [B,1,G,G], mean 1 per picture
    torch::Tensor cameras;     // [B,CameraFeatures]
    torch::Tensor inpaint;     // [B,2+C,G,G], inpainting(); undefined where there are no pictures of before
    torch::Tensor
        outline;  // [B,1,S,S] in [0,1], how much of a pixel is new; undefined where the source does not tell
    torch::Tensor outlined;  // [B,1,S,S], 1 where it may be: what counts of that
};

class ShapeBatches {
public:
    explicit ShapeBatches(const UNetTraining& training)
        : training_(training), table_(training.vocabulary),
          views_(static_cast<std::uint64_t>(training.source.views_of_scene())) {}

    /// Views that are denoised together.
    std::int64_t together() const {
        return std::min<std::int64_t>(ShapeViews, static_cast<std::int64_t>(views_));
    }

    ShapeBatch make(Random& random) const {
        const std::int64_t groups = std::max<std::int64_t>(1, training_.parameters.unet_batch / together());
        const std::int64_t size = groups * together(), cells = training_.pictures.cells;
        ShapeBatch batch;
        batch.ids = torch::full({2 * size, StarterTokenCount}, table_.eos(), torch::kLong);
        batch.next_share = torch::zeros({size, 1, 1});
        batch.timesteps = torch::empty({size}, torch::kLong);
        batch.weights = torch::empty({size, 1, cells, cells});
        batch.cameras = torch::zeros({size, CameraFeatures});
        auto mask = torch::ones({size, 1, cells, cells}), shown = torch::zeros({size, 1, cells, cells}),
             tells = torch::zeros({size, 1, 1, 1});
        std::vector<std::int64_t> rows;
        for (std::int64_t g = 0; g < groups; ++g) {
            fill_group(batch, g * together(), rows, random);
            if (training_.before_latents.mean.defined())
                fill_cells(mask, shown, tells, rows, g * together(), random);
        }
        const auto index = torch::tensor(rows, torch::kLong);
        batch.latents = training_.latents.mean.index_select(0, index) / training_.latents.deviation;
        if (training_.before_latents.mean.defined()) {
            const auto before =
                training_.before_latents.mean.index_select(0, index) / training_.latents.deviation;
            batch.inpaint = inpainting(mask, shown, before);
            batch.latents = torch::where(mask > 0, batch.latents,
                                         before);  // as views are redrawn: their surroundings stay
        }
        if (!training_.pictures.outline.empty()) fill_outlines(batch, mask * tells, rows);
        batch.weights = torch::max_pool2d(batch.weights, 3, 1, 1) + Kept +
                        (Changed - Kept) * mask;  // a thing's rim is drawn, too
        batch.weights = batch.weights / batch.weights.mean({1, 2, 3}, true);
        auto generator = at::make_generator<at::CPUGeneratorImpl>(random.next());
        batch.noise = torch::randn(batch.latents.sizes(), generator);
        return batch;
    }

private:
    /// Some views of a scene, none twice, at one noise level: more often a high one, where shapes are
    /// decided.
    void fill_group(ShapeBatch& batch, std::int64_t first, std::vector<std::int64_t>& rows,
                    Random& random) const {
        const std::uint64_t scene = random.below(training_.pictures.count / views_), words = random.next();
        std::vector<std::uint64_t> views(views_);
        for (std::uint64_t v = 0; v < views_; ++v) views[v] = v;
        const auto timestep = static_cast<std::int64_t>(ShapeTimesteps * std::sqrt(random.uniform()));
        const bool silent = random.uniform() < training_.parameters.caption_dropout,
                   unknown = random.uniform() < UnknownCameras;
        const std::int64_t clean = together() > 2 && random.uniform() < CleanShare
                                       ? 1 + static_cast<std::int64_t>(random.below(2))
                                       : 0;
        for (std::int64_t k = 0; k < together(); ++k) {
            const auto i = static_cast<std::size_t>(k);
            std::swap(views[i], views[i + random.below(views_ - i)]);
            const std::uint64_t picture = scene * views_ + views[i];
            batch.timesteps[first + k] = k < clean ? static_cast<std::int64_t>(random.below(CleanTimesteps))
                                                   : std::min<std::int64_t>(timestep, ShapeTimesteps - 1);
            if (!unknown) {
                const auto camera = training_.source.camera(picture);
                const auto features = camera_features(camera.azimuth, camera.elevation);
                std::copy(features.begin(), features.end(), batch.cameras[first + k].data_ptr<float>());
            }
            fill_weights(batch, first + k, picture);
            if (!silent) fill_sentences(batch, first + k, picture, words);
            rows.push_back(static_cast<std::int64_t>(picture));
        }
    }

    /// What may change and what is shown in each view of a group, whose pictures are the last of `rows`.
    void fill_cells(torch::Tensor& mask, torch::Tensor& shown, torch::Tensor& tells,
                    const std::vector<std::int64_t>& rows, std::int64_t first, Random& random) const {
        const auto cells = static_cast<std::size_t>(training_.pictures.cells * training_.pictures.cells);
        const auto part = [&](const StarterPictures& pictures, std::int64_t row, StarterPart which) {
            const auto place =
                static_cast<std::size_t>(rows[static_cast<std::size_t>(row)]) * StarterPartCount +
                static_cast<std::size_t>(which);
            return std::span(pictures.coverage).subspan(place * cells, cells);
        };
        bool accessory = false;
        for (auto k = first; k < first + together(); ++k)
            accessory = accessory || std::ranges::any_of(part(training_.pictures, k, StarterPart::Accessory),
                                                         [](auto covered) { return covered > 0; });
        const auto task = draw_inpaint_task(accessory, random);
        if (task != InpaintTask::Nothing)
            tells.narrow(0, first, together()).fill_(1);  // else nothing says what is new
        for (auto k = first; k < first + together(); ++k) {
            const auto drawn = draw_inpaint_cells(
                task, part(training_.pictures, k, accessory ? StarterPart::Accessory : StarterPart::Object),
                part(training_.before, k, StarterPart::Object), training_.pictures.cells, random);
            std::copy(drawn.mask.begin(), drawn.mask.end(), mask[k].data_ptr<float>());
            std::copy(drawn.shown.begin(), drawn.shown.end(), shown[k].data_ptr<float>());
        }
    }

    void fill_outlines(ShapeBatch& batch, const torch::Tensor& may_be,
                       const std::vector<std::int64_t>& rows) const {
        const std::int64_t side = training_.pictures.size;
        const auto pixels = static_cast<std::size_t>(side * side);
        auto outline = torch::empty({may_be.size(0), 1, side, side}, torch::kByte);
        for (std::size_t i = 0; i < rows.size(); ++i)
            std::copy_n(&training_.pictures.outline[static_cast<std::size_t>(rows[i]) * pixels], pixels,
                        outline.data_ptr<std::uint8_t>() + i * pixels);
        batch.outline = outline.to(torch::kFloat) / 255;
        batch.outlined = torch::upsample_nearest2d(may_be, {side, side});
    }

    void fill_weights(ShapeBatch& batch, std::int64_t i, std::uint64_t picture) const {
        const auto cells = static_cast<std::size_t>(training_.pictures.cells * training_.pictures.cells);
        const std::uint8_t* parts = &training_.pictures.coverage[picture * StarterPartCount * cells];
        float* weight = batch.weights[i].data_ptr<float>();
        for (std::size_t k = 0; k < cells; ++k)
            weight[k] =
                static_cast<float>((OfObject * parts[cells + k] + OfAccessory * parts[2 * cells + k]) / 255);
    }

    void fill_sentences(ShapeBatch& batch, std::int64_t i, std::uint64_t picture, std::uint64_t words) const {
        const StarterCaption caption = training_.source.caption(picture, words, false);
        const bool two = !caption.next_text.empty();
        fill_words(batch, i, caption.text);
        fill_words(batch, batch.ids.size(0) / 2 + i, two ? caption.next_text : caption.text);
        batch.next_share[i] = two ? caption.next_share : 0.0;
    }

    void fill_words(ShapeBatch& batch, std::int64_t row, const std::string& text) const {
        auto ids = batch.ids.accessor<std::int64_t, 2>();
        ids[row][0] = table_.bos();
        std::int64_t position = 1;
        for (const auto& word : split_caption(text)) {
            if (position >= StarterTokenCount - 1) break;
            ids[row][position++] = table_.id(word);
        }
    }

    const UNetTraining& training_;
    WordTable table_;
    std::uint64_t views_;
};

/// v-prediction (Salimans and Ho 2022).
std::pair<torch::Tensor, std::vector<double>> shape_loss(StarterNetworks& networks, const ShapeBatch& batch,
                                                         std::int64_t together,
                                                         const torch::Tensor& alphas_cumprod, bool bf16) {
    const auto alpha = alphas_cumprod.index_select(0, batch.timesteps).view({-1, 1, 1, 1});
    const auto signal = alpha.sqrt(), sigma = (1 - alpha).sqrt();
    const auto noisy = signal * batch.latents + sigma * batch.noise;
    const auto velocity = signal * batch.noise - sigma * batch.latents;
    torch::Tensor predicted, outline;
    {
        const MixedPrecision precision(bf16, noisy.is_cuda());
        const auto encoded = networks.text->forward(batch.ids).last_hidden;
        const auto size = batch.latents.size(0);
        const auto context = torch::lerp(encoded.narrow(0, 0, size), encoded.narrow(0, size, size),
                                         batch.next_share.to(encoded.scalar_type()));
        predicted = networks.unet
                        ->forward(noisy, batch.timesteps, context, nullptr, {},
                                  {together, batch.cameras, batch.inpaint, &outline})
                        .to(torch::kFloat);
    }
    const auto squared = (predicted - velocity).square();
    const auto loss = (squared * batch.weights).mean();
    if (!batch.outline.defined()) return {loss, {loss.item<double>(), squared.mean().item<double>(), 0}};
    // Beneath much noise there is no outline yet.
    const auto counts = batch.outlined * alpha;
    const auto outlined =
        (torch::binary_cross_entropy_with_logits(outline, batch.outline, {}, {}, at::Reduction::None) *
         counts)
            .sum() /
        counts.sum().clamp_min(1);
    return {loss + OutlineWeight * outlined,
            {loss.item<double>(), squared.mean().item<double>(), outlined.item<double>()}};
}

/// The UNet's matrices and convolutions, all of what it is told and shown of the scene, and the token
/// embeddings, of which only the rows of `fresh` ever get a gradient.
Parameters trained_parameters(StarterNetworks& networks, const std::vector<std::int64_t>& fresh) {
    for (auto& parameter : networks.text->parameters()) parameter.set_requires_grad(false);
    Parameters parameters;
    for (auto& item : networks.unet->named_parameters()) {
        const bool trained = item.value().dim() >= 2 || is_scene_input(item.key());
        item.value().set_requires_grad(trained);
        if (trained) parameters.push_back(item.value());
    }
    for (auto& item : networks.text->named_parameters()) {
        if (fresh.empty() || !item.key().ends_with("token_embedding.weight")) continue;
        auto embedding = item.value();
        embedding.set_requires_grad(true);
        auto mask = torch::zeros({embedding.size(0), 1}, embedding.options().requires_grad(false));
        for (const auto row : fresh) mask[row] = 1.0;
        embedding.register_hook([mask](const torch::Tensor& gradient) { return gradient * mask; });
        parameters.push_back(embedding);
    }
    return parameters;
}

void to_device(ShapeBatch& batch, const torch::Device& device) {
    if (device.is_cpu()) return;
    for (auto* tensor : {&batch.ids, &batch.next_share, &batch.latents, &batch.noise, &batch.timesteps,
                         &batch.weights, &batch.cameras, &batch.inpaint, &batch.outline, &batch.outlined})
        if (tensor->defined()) *tensor = tensor->to(device);
}

}  // namespace

void train_shapes(StarterNetworks& networks, const UNetTraining& training,
                  const std::vector<std::int64_t>& fresh, const std::filesystem::path& work,
                  const JobControl& job) {
    const auto& parameters = training.parameters;
    const torch::Device device(parameters.device);
    const auto alphas_cumprod = NoiseSchedule(SchedulerConfig{}).alphas_cumprod().to(device);
    const ShapeBatches batches(training);
    const auto copy = [&] {
        StarterNetworks other{ClipTextEncoder(training.configs.text), UNet(networks.unet->config())};
        auto text = other.text->parameters(), unet = other.unet->parameters();
        copy_parameters(networks.text->parameters(), text);
        copy_parameters(networks.unet->parameters(), unet);
        return other;
    };
    std::vector<StarterNetworks> replicas{networks};
    for (int r = 1; r < parameters.threads; ++r) replicas.push_back(copy());
    Stage stage;
    stage.name = "shapes";
    stage.peak_lr = parameters.unet_lr;
    stage.weight_decay = 0;  // what does not change is not to be drawn to zero
    stage.columns = {"loss", "diffusion", "outline"};
    auto averaged = copy();
    auto averaged_parameters = trained_parameters(averaged, fresh);
    for (auto& replica : replicas) {
        replica.text->to(device);
        replica.unet->to(device);
        stage.replicas.push_back(trained_parameters(replica, fresh));
    }
    stage.checkpoint = [&](const Parameters& values) {
        copy_parameters(values, averaged_parameters);
        if (training.preview) training.preview(averaged);
    };
    stage.loss = [&](std::size_t r, std::int64_t step) {
        Random random =
            Random::stream(parameters.seed * 3 + 2, static_cast<std::uint64_t>(step) * replicas.size() + r);
        ShapeBatch batch = batches.make(random);
        to_device(batch, device);
        return shape_loss(replicas[r], batch, batches.together(), alphas_cumprod, parameters.bf16);
    };
    run_stage(stage, StageClock(parameters.unet_steps, parameters.unet_minutes), work, job);
}

}  // namespace gse::neural
