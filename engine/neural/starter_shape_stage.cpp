// Trains what draws new things: the UNet's weights, which become a LoRA beside those that look for things, and the words for the
// sides of a thing. Every caption says from where the picture was taken; between two sides the encoded sentences are mixed, as
// view-dependent prompting does (threestudio, Perp-Neg: Armandpour et al. 2023), so the model learns every azimuth. What counts of
// a picture is mostly the thing, for of a redrawn view nothing else is kept.
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/neural/mixed_precision.h"
#include "engine/neural/schedulers.h"
#include "engine/neural/starter_stages.h"
#include "engine/neural/starter_words.h"

namespace gse::neural {
namespace {

constexpr int ShapeTimesteps = 1000;
// Weight of a latent cell: of the surroundings, what is added for the object and for an accessory, which is small.
constexpr double Surroundings = 0.4, OfObject = 1, OfAccessory = 2;

struct ShapeBatch {
    torch::Tensor ids;         // [2B,T] long: the sentences, then those of the next side
    torch::Tensor next_share;  // [B,1,1]
    torch::Tensor latents;     // [B,C,G,G] scaled
    torch::Tensor noise;       // [B,C,G,G]
    torch::Tensor timesteps;   // [B] long
    torch::Tensor weights;     // [B,1,G,G], mean 1 per picture
};

class ShapeBatches {
public:
    explicit ShapeBatches(const UNetTraining& training) : training_(training), table_(training.vocabulary) {}

    ShapeBatch make(Random& random) const {
        const std::int64_t size = training_.parameters.unet_batch, cells = training_.pictures.cells;
        ShapeBatch batch;
        batch.ids = torch::full({2 * size, StarterTokenCount}, table_.eos(), torch::kLong);
        batch.next_share = torch::zeros({size, 1, 1});
        batch.timesteps = torch::empty({size}, torch::kLong);
        batch.weights = torch::empty({size, 1, cells, cells});
        std::vector<std::int64_t> rows;
        for (std::int64_t i = 0; i < size; ++i) rows.push_back(fill_row(batch, i, random));
        const auto index = torch::tensor(rows, torch::kLong);
        batch.latents = training_.latents.mean.index_select(0, index) / training_.latents.deviation;
        batch.weights = torch::max_pool2d(batch.weights, 3, 1, 1) + Surroundings;   // a thing's rim is drawn, too
        batch.weights = batch.weights / batch.weights.mean({1, 2, 3}, true);
        auto generator = at::make_generator<at::CPUGeneratorImpl>(random.next());
        batch.noise = torch::randn(batch.latents.sizes(), generator);
        return batch;
    }

private:
    std::int64_t fill_row(ShapeBatch& batch, std::int64_t i, Random& random) const {
        const std::uint64_t picture = random.below(training_.pictures.count);
        batch.timesteps[i] = static_cast<std::int64_t>(random.below(ShapeTimesteps));
        const auto cells = static_cast<std::size_t>(training_.pictures.cells * training_.pictures.cells);
        const std::uint8_t* parts = &training_.pictures.coverage[picture * StarterPartCount * cells];
        float* weight = batch.weights[i].data_ptr<float>();
        for (std::size_t k = 0; k < cells; ++k)
            weight[k] = static_cast<float>((OfObject * parts[cells + k] + OfAccessory * parts[2 * cells + k]) / 255);
        const StarterCaption caption = training_.source.caption(picture, random.next(), false);
        if (random.uniform() < training_.parameters.caption_dropout) return static_cast<std::int64_t>(picture);
        const bool two = !caption.next_text.empty();
        fill_words(batch, i, caption.text);
        fill_words(batch, training_.parameters.unet_batch + i, two ? caption.next_text : caption.text);
        batch.next_share[i] = two ? caption.next_share : 0.0;
        return static_cast<std::int64_t>(picture);
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
};

/// v-prediction (Salimans and Ho 2022).
std::pair<torch::Tensor, std::vector<double>> shape_loss(StarterNetworks& networks, const ShapeBatch& batch,
                                                         const torch::Tensor& alphas_cumprod, bool bf16) {
    const auto alpha = alphas_cumprod.index_select(0, batch.timesteps).view({-1, 1, 1, 1});
    const auto signal = alpha.sqrt(), sigma = (1 - alpha).sqrt();
    const auto noisy = signal * batch.latents + sigma * batch.noise;
    const auto velocity = signal * batch.noise - sigma * batch.latents;
    torch::Tensor predicted;
    {
        const MixedPrecision precision(bf16, noisy.is_cuda());
        const auto encoded = networks.text->forward(batch.ids).last_hidden;
        const auto size = batch.latents.size(0);
        const auto context = torch::lerp(encoded.narrow(0, 0, size), encoded.narrow(0, size, size), batch.next_share.to(encoded.scalar_type()));
        predicted = networks.unet->forward(noisy, batch.timesteps, context).to(torch::kFloat);
    }
    const auto squared = (predicted - velocity).square();
    const auto loss = (squared * batch.weights).mean();
    return {loss, {loss.item<double>(), squared.mean().item<double>()}};
}

/// The UNet's matrices and convolutions, and the token embeddings, of which only the rows of `fresh` ever get a gradient.
Parameters trained_parameters(StarterNetworks& networks, const std::vector<std::int64_t>& fresh) {
    for (auto& parameter : networks.text->parameters()) parameter.set_requires_grad(false);
    Parameters parameters;
    for (auto& parameter : networks.unet->parameters()) {
        parameter.set_requires_grad(parameter.dim() >= 2);
        if (parameter.dim() >= 2) parameters.push_back(parameter);
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
    for (auto* tensor : {&batch.ids, &batch.next_share, &batch.latents, &batch.noise, &batch.timesteps, &batch.weights})
        *tensor = tensor->to(device);
}

}  // namespace

void train_shapes(StarterNetworks& networks, const UNetTraining& training, const std::vector<std::int64_t>& fresh,
                  const std::filesystem::path& work, const JobControl& job) {
    const auto& parameters = training.parameters;
    const torch::Device device(parameters.device);
    const auto alphas_cumprod = NoiseSchedule(SchedulerConfig{}).alphas_cumprod().to(device);
    const ShapeBatches batches(training);
    const auto copy = [&] {
        StarterNetworks other{ClipTextEncoder(training.configs.text), UNet(training.configs.unet)};
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
    stage.weight_decay = 0;   // what does not change is not to be drawn to zero
    stage.columns = {"loss", "diffusion"};
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
        Random random = Random::stream(parameters.seed * 3 + 2, static_cast<std::uint64_t>(step) * replicas.size() + r);
        ShapeBatch batch = batches.make(random);
        to_device(batch, device);
        return shape_loss(replicas[r], batch, alphas_cumprod, parameters.bf16);
    };
    run_stage(stage, StageClock(parameters.unet_steps, parameters.unet_minutes), work, job);
}

}  // namespace gse::neural
