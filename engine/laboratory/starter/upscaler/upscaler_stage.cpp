// Trains the upscaler: from what the VAE decodes to pictures of four times the size. The loss is L1, L1 of
// the gradients, and L1 of their mean magnitude over patches: where it is not known which detail there was,
// its strength counts.
#include <cmath>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/diffusion/upscaler.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::training {
namespace {

constexpr double EdgeWeight = 0.5, DetailWeight = 0.5;
constexpr std::int64_t DetailPatch = 8;  // pixels of the large picture
constexpr std::int64_t CellPixels = 4;   // of the coverage maps
constexpr int CropCells = 8;             // latent cells along a side of what one sample shows
constexpr int CropsTried = 4;            // the one that shows most of things is taken
constexpr std::int64_t EncodedAtOnce = 64;
constexpr std::int64_t HeldOutPart = 20;   // one picture of so many, of the last scenes
constexpr std::int64_t MostMeasured = 48;  // of those
/// Share of the pictures whose latents are a denoiser's guess instead of the VAE's, and its most noise, as
/// shares of the pictures and of the schedule.
constexpr double GuessedShare = 0.5, MostNoise = 0.5;

/// The inputs of all pictures.
struct UpscalerInputs {
    torch::Tensor latents;  // [N,C,G,G] as the UNet sees them
    torch::Tensor decoded;  // [N,3,S,S] bytes
};

torch::Tensor floats(const torch::Tensor& bytes) { return bytes.to(torch::kFloat).div(127.5).sub(1.0); }

torch::Tensor bytes_of(const torch::Tensor& pictures) {
    return pictures.add(1).mul(127.5).round().clamp(0, 255).to(torch::kUInt8);
}

/// [N,3,S,S] view of a run's pictures.
torch::Tensor all_pictures(const StarterPictures& pictures) {
    const std::int64_t side = pictures.size;
    return torch::from_blob(const_cast<std::uint8_t*>(pictures.rgb.data()),
                            {static_cast<std::int64_t>(pictures.count), side, side, 3}, torch::kUInt8)
        .permute({0, 3, 1, 2});
}

/// Guesses of the UNet, which is told no sentence, at noised latents: blurred as drawn ones are.
torch::Tensor guessed(const ModelBundle& model, const torch::Tensor& latents, const torch::Tensor& context,
                      Random& random) {
    const auto count = latents.size(0);
    auto timesteps = torch::zeros({count}, torch::kLong);
    auto taken = torch::zeros({count, 1, 1, 1});
    for (std::int64_t i = 0; i < count; ++i) {
        timesteps[i] = static_cast<std::int64_t>(random.uniform() * MostNoise *
                                                 static_cast<double>(model.schedule.steps() - 1));
        if (random.uniform() < GuessedShare) taken[i] = 1.0;
    }
    const auto noisy =
        model.schedule.add_noise(latents, seeded_noise(latents.sizes(), random.next()), timesteps);
    const auto output = model.unet->forward(noisy, timesteps, context.expand({count, -1, -1}));
    return taken * model.schedule.to_x0(output, noisy, timesteps) + (1 - taken) * latents;
}

UpscalerInputs encode_inputs(const ModelBundle& model, const StarterPictures& small, std::uint64_t seed,
                             const JobControl& job) {
    const torch::NoGradGuard no_grad;
    const auto pictures = all_pictures(small);
    const auto count = pictures.size(0);
    UpscalerInputs inputs;
    inputs.latents = torch::empty({count, model.latent_channels(), small.cells, small.cells});
    inputs.decoded = torch::empty({count, 3, small.size, small.size}, torch::kUInt8);
    const auto context = model.encode_prompts({""});
    for (std::int64_t first = 0; first < count; first += EncodedAtOnce) {
        if (job.stop_requested())
            throw Error(ErrorCode::Cancelled, "stopped while encoding the training pictures");
        const auto size = std::min(EncodedAtOnce, count - first);
        Random random = Random::stream(seed * 3 + 5, static_cast<std::uint64_t>(first));
        const auto clean =
            image_to_latents(model, floats(pictures.narrow(0, first, size)).add(1).div(2).contiguous());
        const auto latents = guessed(model, clean, context, random);
        inputs.latents.narrow(0, first, size).copy_(latents);
        inputs.decoded.narrow(0, first, size).copy_(bytes_of(latents_to_image(model, latents) * 2 - 1));
        job.report("encoding pictures", static_cast<int>(first + size), static_cast<int>(count));
    }
    return inputs;
}

/// One replica's batch, of sections of pictures.
struct UpscalerBatch {
    torch::Tensor decoded, latents, truth;
};

class UpscalerBatches {
public:
    UpscalerBatches(const StarterPictures& small, const StarterPictures& large, const UpscalerInputs& inputs)
        : small_(small), large_(large), inputs_(inputs), truth_(all_pictures(large)),
          trained_(truth_.size(0) - std::max<std::int64_t>(1, truth_.size(0) / HeldOutPart)) {}

    /// Whole pictures that make() never shows.
    UpscalerBatch held_out() const {
        const auto left = truth_.size(0) - trained_, step = std::max<std::int64_t>(1, left / MostMeasured);
        const auto rows = torch::arange(trained_, truth_.size(0), step, torch::kLong);
        const auto of = [&](const torch::Tensor& all) { return all.index_select(0, rows); };
        return {floats(of(inputs_.decoded)), of(inputs_.latents), floats(of(truth_)).contiguous()};
    }

    UpscalerBatch make(int size, Random& random) const {
        const std::int64_t crop = std::min(CropCells, small_.cells);
        const auto cell = static_cast<std::int64_t>(small_.size / small_.cells);
        std::vector<torch::Tensor> decoded, latents, truth;
        const auto cut = [](const torch::Tensor& from, std::int64_t x, std::int64_t y, std::int64_t side) {
            return from.narrow(1, y, side).narrow(2, x, side);
        };
        for (int i = 0; i < size; ++i) {
            const auto picture =
                static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(trained_)));
            const auto [x, y] = place(picture, crop, random);
            latents.push_back(cut(inputs_.latents[picture], x, y, crop));
            decoded.push_back(cut(inputs_.decoded[picture], x * cell, y * cell, crop * cell));
            const auto large = cell * UpscaleFactor;
            truth.push_back(cut(truth_[picture], x * large, y * large, crop * large));
        }
        return {floats(torch::stack(decoded)), torch::stack(latents),
                floats(torch::stack(truth)).contiguous()};
    }

private:
    /// The corner of a section that shows much of things.
    std::pair<std::int64_t, std::int64_t> place(std::int64_t picture, std::int64_t crop,
                                                Random& random) const {
        const auto range = static_cast<std::uint64_t>(small_.cells - crop + 1);
        std::pair<std::int64_t, std::int64_t> best{};
        std::int64_t most = -1;
        for (int tried = 0; tried < CropsTried; ++tried) {
            const auto x = static_cast<std::int64_t>(random.below(range)),
                       y = static_cast<std::int64_t>(random.below(range));
            if (const auto shown = covered(picture, x, y, crop); shown > most) most = shown, best = {x, y};
        }
        return best;
    }
    /// Object and accessory within a section, in 255ths of cells.
    std::int64_t covered(std::int64_t picture, std::int64_t x, std::int64_t y, std::int64_t crop) const {
        const auto cells = static_cast<std::int64_t>(small_.cells), area = cells * cells;
        std::int64_t sum = 0;
        for (const auto part : {StarterPart::Object, StarterPart::Accessory}) {
            const auto* map = &small_.coverage[static_cast<std::size_t>(
                (picture * StarterPartCount + static_cast<int>(part)) * area)];
            for (auto v = y; v < y + crop; ++v)
                for (auto u = x; u < x + crop; ++u) sum += map[v * cells + u];
        }
        return sum;
    }

    const StarterPictures &small_, &large_;
    const UpscalerInputs& inputs_;
    torch::Tensor truth_;
    std::int64_t trained_;
};

/// Forward differences along x and y, [B,C,H-1,W-1] each.
std::pair<torch::Tensor, torch::Tensor> differences(const torch::Tensor& x) {
    const auto corner = x.slice(2, 0, -1).slice(3, 0, -1);
    return {x.slice(2, 0, -1).slice(3, 1) - corner, x.slice(2, 1).slice(3, 0, -1) - corner};
}

torch::Tensor mean_magnitude(const std::pair<torch::Tensor, torch::Tensor>& gradient) {
    constexpr double Least = 1e-6;  // squared: the root has a slope at zero
    const auto magnitude = (gradient.first.square() + gradient.second.square() + Least).sqrt();
    return torch::avg_pool2d(magnitude, {DetailPatch, DetailPatch}, {DetailPatch / 2, DetailPatch / 2});
}

double energy(const std::pair<torch::Tensor, torch::Tensor>& gradient) {
    return (gradient.first.square() + gradient.second.square()).mean().item<double>();
}

/// The loss, and for the log: it, the error in dB, that of mere enlargement, gradient energies of both over
/// the truth's.
std::pair<torch::Tensor, std::vector<double>> upscaler_loss(const Upscaler& network,
                                                            const UpscalerBatch& batch) {
    const auto shown = network->forward(batch.decoded, batch.latents);
    const auto of_shown = differences(shown), of_truth = differences(batch.truth);
    const auto loss = (shown - batch.truth).abs().mean() +
                      EdgeWeight * ((of_shown.first - of_truth.first).abs().mean() +
                                    (of_shown.second - of_truth.second).abs().mean()) +
                      DetailWeight * (mean_magnitude(of_shown) - mean_magnitude(of_truth)).abs().mean();
    const torch::NoGradGuard no_grad;
    const auto plain =
        torch::upsample_bicubic2d(batch.decoded, {batch.truth.size(2), batch.truth.size(3)}, false);
    const auto decibel = [&](const torch::Tensor& picture) {
        return -10 * std::log10(std::max((picture - batch.truth).square().mean().item<double>() / 4, 1e-12));
    };
    const double truth = std::max(energy(of_truth), 1e-12);
    return {loss,
            {loss.item<double>(), decibel(shown), decibel(plain), energy(of_shown) / truth,
             energy(differences(plain)) / truth}};
}

void tell_held_out(const Upscaler& network, const UpscalerBatch& batch) {
    const torch::NoGradGuard no_grad;
    const auto figures = upscaler_loss(network, batch).second;
    log::info(
        "upscaler, {} held-out pictures: loss {:.4f}; {:.2f} dB, enlarged {:.2f} dB; gradient energy {:.3f}, "
        "enlarged {:.3f}",
        batch.truth.size(0), figures[0], figures[1], figures[2], figures[3], figures[4]);
}

void export_upscaler(const Upscaler& network, const std::filesystem::path& folder) {
    const torch::NoGradGuard no_grad;
    std::vector<std::pair<std::string, torch::Tensor>> tensors;
    for (const auto& item : network->named_parameters())
        tensors.emplace_back(item.key(), item.value().detach().to(torch::kHalf).contiguous());
    write_safetensors(folder / "model.safetensors", tensors);
    write_file(folder / "config.json", network->config().to_json().dump(2) + "\n");
}

}  // namespace

void train_upscaler(const ModelBundle& model, const StarterTrainParameters& requested,
                    const StarterSource& source, const std::filesystem::path& work,
                    const std::filesystem::path& folder, const JobControl& job) {
    auto parameters = requested;
    parameters.pictures = parameters.upscaler_pictures;
    parameters.image_size = static_cast<int>(model.image_size());
    if (model.image_size() != model.latent_size() * CellPixels)
        throw Error(ErrorCode::Unsupported,
                    "upscalers are trained for models of 4 pixels per latent cell alone", {}, model.path);
    const auto small = load_or_render_pictures(parameters, source, work, job);
    parameters.image_size *= static_cast<int>(UpscaleFactor);
    const auto large = load_or_render_pictures(parameters, source, work, job);
    const auto inputs = encode_inputs(model, small, parameters.seed, job);
    const UpscalerBatches batches(small, large, inputs);
    UpscalerConfig config;
    config.latent_channels = model.latent_channels();
    torch::manual_seed(parameters.seed + 3);
    std::vector<Upscaler> replicas;
    Stage stage;
    stage.name = "upscaler";
    stage.peak_lr = parameters.upscaler_lr;
    stage.columns = {"loss", "psnr_db", "enlarged_db", "energy", "enlarged_energy"};
    for (int r = 0; r < parameters.threads; ++r) {
        replicas.emplace_back(config);
        stage.replicas.push_back(replicas.back()->parameters());
    }
    stage.loss = [&](std::size_t r, std::int64_t step) {
        Random random =
            Random::stream(parameters.seed * 3 + 6, static_cast<std::uint64_t>(step) * replicas.size() + r);
        return upscaler_loss(replicas[r], batches.make(parameters.upscaler_batch, random));
    };
    const auto held_out = batches.held_out();
    Upscaler averaged(config);
    auto averaged_parameters = averaged->parameters();
    // The unfinished network can be tried while the training goes on.
    stage.checkpoint = [&](const Parameters& values) {
        copy_parameters(values, averaged_parameters);
        export_upscaler(averaged, work / "preview/upscaler");
        tell_held_out(averaged, held_out);
    };
    run_stage(stage, StageClock(parameters.upscaler_steps, parameters.upscaler_minutes), work, job);
    export_upscaler(replicas.front(), folder);
}

}  // namespace gse::training
