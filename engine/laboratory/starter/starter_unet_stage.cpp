// Trains text encoder and UNet: v-prediction on cached latents, and losses that place each word's attention.
// The attention losses use the generator's own part masks (as TokenCompose, Wang et al. 2023, uses
// segmentations).
//
// - place: binary cross-entropy, per latent cell, of the attention that all words of a part receive against
//   the part's coverage. Inside and outside are balanced as far as the outside is not much larger.
// - spread: KL from the part's coverage to each word's own attention over the image, so a word covers its
//   part evenly.
// - insertion: pictures without an accessory are also shown with a caption that names one. Only the attention
//   losses count there, with the mask of the twin scene. The words learn where an object belongs before it is
//   there.
#include <cmath>
#include <unordered_map>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/laboratory/starter/mixed_precision.h"
#include "engine/laboratory/starter/split_caption.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/laboratory/starter/starter_words.h"
#include "engine/neural/diffusion/schedulers.h"

namespace gse::training {
namespace {

constexpr int TrainTimesteps = 1000;
// Areas of the part that count as its outside in the balance of the place loss.
constexpr double MostOutsideAreas = 3;

/// One replica's batch.
struct Batch {
    torch::Tensor ids;        // [B,T] long
    torch::Tensor latents;    // [B,C,G,G] scaled
    torch::Tensor noise;      // [B,C,G,G]
    torch::Tensor timesteps;  // [B] long
    torch::Tensor words;      // [B,T,3] 1 where the token names the part
    torch::Tensor coverage;   // [B,3,G,G] in [0,1]
    torch::Tensor diffusion;  // [B] 1 = the diffusion loss counts
};

class BatchMaker {
public:
    explicit BatchMaker(const UNetTraining& training)
        : parameters_(training.parameters), pictures_(training.pictures), latents_(training.latents),
          source_(training.source), table_(training.vocabulary) {}

    Batch make(Random& random) const {
        const std::int64_t size = parameters_.unet_batch;
        const std::int64_t cells = pictures_.cells;
        Batch batch;
        batch.ids = torch::full({size, StarterTokenCount}, table_.eos(), torch::kLong);
        batch.words = torch::zeros({size, StarterTokenCount, StarterPartCount});
        batch.coverage = torch::empty({size, StarterPartCount, cells, cells});
        batch.diffusion = torch::ones({size});
        batch.timesteps = torch::empty({size}, torch::kLong);
        std::vector<std::int64_t> rows;
        for (std::int64_t i = 0; i < size; ++i) rows.push_back(fill_row(batch, i, random));
        const auto index = torch::tensor(rows, torch::kLong);
        batch.latents = latents_.mean.index_select(0, index) / latents_.deviation;
        auto generator = at::make_generator<at::CPUGeneratorImpl>(random.next());
        batch.noise = torch::randn(batch.latents.sizes(), generator);
        return batch;
    }

private:
    std::int64_t fill_row(Batch& batch, std::int64_t i, Random& random) const {
        const std::uint64_t picture = random.below(pictures_.count);
        const bool insertion =
            pictures_.bare_twin[picture] != 0 && random.uniform() < parameters_.insertion_share;
        batch.timesteps[i] = static_cast<std::int64_t>(random.below(TrainTimesteps));
        copy_coverage(batch, i, picture, insertion);
        if (insertion) batch.diffusion[i] = 0.0;
        const StarterCaption caption = source_.caption(picture, random.next(), insertion);
        const bool dropped = !insertion && random.uniform() < parameters_.caption_dropout;
        auto ids = batch.ids.accessor<std::int64_t, 2>();
        ids[i][0] = table_.bos();
        if (!dropped) fill_words(batch, i, caption, insertion);
        return static_cast<std::int64_t>(picture);
    }

    void copy_coverage(Batch& batch, std::int64_t i, std::uint64_t picture, bool insertion) const {
        const auto cells = static_cast<std::size_t>(pictures_.cells * pictures_.cells);
        const std::uint8_t* from = &pictures_.coverage[picture * StarterPartCount * cells];
        float* to = batch.coverage[i].data_ptr<float>();
        for (std::size_t k = 0; k < StarterPartCount * cells; ++k)
            to[k] = static_cast<float>(from[k]) / 255.0f;
        // Without the accessory in the picture its map only serves insertion captions.
        if (pictures_.bare_twin[picture] != 0 && !insertion) std::fill(to + 2 * cells, to + 3 * cells, 0.0f);
    }

    void fill_words(Batch& batch, std::int64_t i, const StarterCaption& caption, bool insertion) const {
        auto ids = batch.ids.accessor<std::int64_t, 2>();
        auto words = batch.words.accessor<float, 3>();
        std::unordered_map<std::string, int> seen;
        std::int64_t position = 1;
        for (const auto& word : split_caption(caption.text)) {
            if (position >= StarterTokenCount - 1) break;
            ids[i][position] = table_.id(word);
            const int occurrence = seen[word]++;
            for (const auto& grounding : caption.groundings)
                if (grounding.word == word && grounding.occurrence == occurrence &&
                    (!insertion || grounding.part == StarterPart::Accessory))
                    words[i][position][static_cast<int>(grounding.part)] = 1.0f;
            ++position;
        }
    }

    const StarterTrainParameters& parameters_;
    const StarterPictures& pictures_;
    const StarterLatents& latents_;
    const StarterSource& source_;
    WordTable table_;
};

struct AttentionLosses {
    torch::Tensor place, spread;
};

/// Losses of one captured layer; probabilities [B,heads,hw,T].
AttentionLosses layer_losses(const AttentionCapture::Map& map, const Batch& batch) {
    const auto probabilities = map.probabilities.to(torch::kFloat).mean(1);  // [B,hw,T]
    // [B,3,hw].
    auto coverage = torch::adaptive_avg_pool2d(batch.coverage, {map.height, map.width}).flatten(2);
    const auto area = coverage.sum(2);                                                               // [B,3]
    const auto named = (batch.words.sum(1) > 0).to(torch::kFloat) * (area > 0.5).to(torch::kFloat);  // [B,3]
    const auto count = named.sum().clamp_min(1.0);

    // [B,3,hw].
    const auto together = torch::bmm(probabilities, batch.words).transpose(1, 2).clamp(1e-4, 1 - 1e-4);
    const auto outside = 1 - coverage;
    const auto inside_loss = -(coverage * together.log()).sum(2) / area.clamp_min(1e-3);
    // The balance is bounded: with full balance a small part would be allowed many times its area of false
    // attention.
    const auto outside_area = torch::minimum(outside.sum(2), area * MostOutsideAreas).clamp_min(1e-3);
    const auto outside_loss = -(outside * (1 - together).log()).sum(2) / outside_area;
    const auto place = (0.5 * (inside_loss + outside_loss) * named).sum() / count;

    const auto share = probabilities / probabilities.sum(1, true).clamp_min(1e-6);  // [B,hw,T]
    const auto target = coverage / area.unsqueeze(2).clamp_min(1e-3);               // [B,3,hw]
    const auto cross = -torch::bmm(target, (share + 1e-6).log());                   // [B,3,T]
    const auto entropy = -(target * (target + 1e-9).log()).sum(2, true);            // [B,3,1]
    const auto pairs = batch.words.transpose(1, 2) * named.unsqueeze(2);            // [B,3,T]
    const auto spread = ((cross - entropy) * pairs).sum() / pairs.sum().clamp_min(1.0);
    return {place, spread};
}

/// Mean over the supervised layers: the decoder's, from 8x8 cells up.
AttentionLosses attention_losses(const AttentionCapture& capture, const Batch& batch) {
    AttentionLosses total{torch::zeros({}, batch.coverage.device()),
                          torch::zeros({}, batch.coverage.device())};
    int layers = 0;
    for (const auto& map : capture.maps) {
        if (map.layer.rfind("up_blocks", 0) != 0) continue;
        const auto losses = layer_losses(map, batch);
        total.place = total.place + losses.place;
        total.spread = total.spread + losses.spread;
        ++layers;
    }
    const double share = 1.0 / std::max(layers, 1);
    return {total.place * share, total.spread * share};
}

void move_to(Batch& batch, const torch::Device& device) {
    if (device.is_cpu()) return;
    for (auto* tensor : {&batch.ids, &batch.latents, &batch.noise, &batch.timesteps, &batch.words,
                         &batch.coverage, &batch.diffusion})
        *tensor = tensor->to(device);
}

/// Training loss of one batch: v-prediction (Salimans and Ho 2022) plus the attention losses.
std::pair<torch::Tensor, std::vector<double>> batch_loss(StarterNetworks& networks, Batch& batch,
                                                         const torch::Tensor& alphas_cumprod,
                                                         const StarterTrainParameters& parameters) {
    const auto alpha = alphas_cumprod.index_select(0, batch.timesteps).view({-1, 1, 1, 1});
    const auto signal = alpha.sqrt();
    const auto sigma = (1 - alpha).sqrt();
    const auto noisy = signal * batch.latents + sigma * batch.noise;
    const auto velocity = signal * batch.noise - sigma * batch.latents;
    AttentionCapture capture;
    capture.keep_graph = true;
    torch::Tensor predicted;
    {
        const MixedPrecision precision(parameters.bf16, noisy.is_cuda());
        const auto context = networks.text->forward(batch.ids).last_hidden;
        predicted = networks.unet->forward(noisy, batch.timesteps, context, &capture).to(torch::kFloat);
    }
    const auto per_sample = (predicted - velocity).square().mean({1, 2, 3});
    const auto diffusion = (per_sample * batch.diffusion).sum() / batch.diffusion.sum().clamp_min(1.0);
    const auto attention = attention_losses(capture, batch);
    const auto loss = diffusion + parameters.grounding_weight * attention.place +
                      parameters.spread_weight * attention.spread;
    return {loss,
            {loss.item<double>(), diffusion.item<double>(), attention.place.item<double>(),
             attention.spread.item<double>()}};
}

Parameters trainable(StarterNetworks& networks) {
    Parameters parameters = networks.text->parameters();
    for (const auto& parameter : networks.unet->parameters()) parameters.push_back(parameter);
    return parameters;
}

}  // namespace

void train_unet(StarterNetworks& networks, const UNetTraining& training, const std::filesystem::path& work,
                const JobControl& job) {
    const auto& configs = training.configs;
    const auto& parameters = training.parameters;
    const torch::Device device(parameters.device);
    const auto alphas_cumprod = NoiseSchedule(SchedulerConfig{}).alphas_cumprod().to(device);
    const BatchMaker batches(training);
    std::vector<StarterNetworks> replicas{networks};
    for (int r = 1; r < parameters.threads; ++r)
        replicas.push_back({ClipTextEncoder(configs.text), UNet(configs.unet)});
    Stage stage;
    stage.name = "unet";
    stage.peak_lr = parameters.unet_lr;
    stage.columns = {"loss", "diffusion", "place", "spread"};
    for (auto& replica : replicas) {
        replica.text->to(device);
        replica.unet->to(device);
        stage.replicas.push_back(trainable(replica));
    }
    StarterNetworks averaged{ClipTextEncoder(configs.text), UNet(configs.unet)};
    auto averaged_parameters = trainable(averaged);
    stage.checkpoint = [&](const Parameters& values) {
        copy_parameters(values, averaged_parameters);
        if (training.preview) training.preview(averaged);
    };
    stage.loss = [&](std::size_t r, std::int64_t step) {
        Random random =
            Random::stream(parameters.seed * 3 + 2, static_cast<std::uint64_t>(step) * replicas.size() + r);
        Batch batch = batches.make(random);
        move_to(batch, device);
        return batch_loss(replicas[r], batch, alphas_cumprod, parameters);
    };
    run_stage(stage, StageClock(parameters.unet_steps, parameters.unet_minutes), work, job);
}

}  // namespace gse::training
