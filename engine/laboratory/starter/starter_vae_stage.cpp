// Trains the starter VAE: L1 + 2 MSE + 0.5 gradient L1 + a small KL, averaged weights.
#include <cstring>

#include "engine/base/random.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/neural/layers/parallel_for_batches.h"

namespace gse::training {
namespace {

constexpr double KlWeight = 5e-4;
constexpr double MseWeight = 2.0;
constexpr double EdgeWeight = 0.5;

/// [B,3,S,S] in [-1,1] from random pictures, mirrored half of the time.
torch::Tensor picture_batch(const StarterPictures& pictures, int batch, Random& random) {
    const std::int64_t side = pictures.size;
    auto bytes = torch::empty({batch, side, side, 3}, torch::kUInt8);
    const std::size_t stride = static_cast<std::size_t>(side * side * 3);
    for (int i = 0; i < batch; ++i)
        std::memcpy(bytes.data_ptr<std::uint8_t>() + static_cast<std::size_t>(i) * stride,
                    &pictures.rgb[random.below(pictures.count) * stride], stride);
    auto images = bytes.permute({0, 3, 1, 2}).to(torch::kFloat).div_(127.5).sub_(1.0);
    if (random.uniform() < 0.5) images = images.flip({3});
    return images.contiguous();
}

torch::Tensor edge_loss(const torch::Tensor& a, const torch::Tensor& b) {
    const auto error = a - b;
    const auto dx = error.slice(3, 1) - error.slice(3, 0, -1);
    const auto dy = error.slice(2, 1) - error.slice(2, 0, -1);
    return dx.abs().mean() + dy.abs().mean();
}

}  // namespace

void train_vae(AutoencoderKl& vae, const StarterTrainParameters& parameters, const StarterPictures& pictures,
               const std::filesystem::path& work, const JobControl& job) {
    const torch::Device device(parameters.device);
    std::vector<AutoencoderKl> replicas{vae};
    for (int r = 1; r < parameters.threads; ++r) replicas.emplace_back(vae->config());
    Stage stage;
    stage.name = "vae";
    stage.peak_lr = parameters.vae_lr;
    stage.columns = {"loss", "psnr_db", "kl"};
    for (auto& replica : replicas) {
        replica->to(device);
        stage.replicas.push_back(replica->parameters());
    }
    stage.loss = [&](std::size_t r, std::int64_t step) {
        Random random =
            Random::stream(parameters.seed * 3 + 1, static_cast<std::uint64_t>(step) * replicas.size() + r);
        torch::Tensor images;
        torch::Tensor noise;
        {
            images = picture_batch(pictures, parameters.vae_batch, random).to(device);
            auto generator = at::make_generator<at::CPUGeneratorImpl>(random.next());
            const std::int64_t cells = pictures.cells;
            noise = torch::randn({parameters.vae_batch, replicas[r]->config().latent_channels, cells, cells},
                                 generator)
                        .to(device);
        }
        const auto [mean, logvar] = replicas[r]->encode_moments(images);
        const auto decoded = replicas[r]->decode(mean + torch::exp(0.5 * logvar) * noise);
        const auto mse = (decoded - images).square().mean();
        const auto kl = 0.5 * (mean.square() + logvar.exp() - 1 - logvar).mean();
        const auto loss = (decoded - images).abs().mean() + MseWeight * mse +
                          EdgeWeight * edge_loss(decoded, images) + KlWeight * kl;
        const double psnr = -10 * std::log10(std::max(mse.item<double>() / 4, 1e-12));
        return std::pair{loss, std::vector<double>{loss.item<double>(), psnr, kl.item<double>()}};
    };
    run_stage(stage, StageClock(parameters.vae_steps, parameters.vae_minutes), work, job);
}

StarterLatents encode_pictures(AutoencoderKl& vae, const StarterTrainParameters& parameters,
                               const StarterPictures& pictures) {
    torch::NoGradGuard no_grad;
    const torch::Device device(parameters.device);
    const std::int64_t side = pictures.size;
    const std::int64_t cells = pictures.cells;
    const auto count = static_cast<std::int64_t>(pictures.count);
    constexpr std::int64_t batch = 64;
    StarterLatents latents;
    latents.mean = torch::empty({count, vae->config().latent_channels, cells, cells});
    const auto encode = [&](std::int64_t begin) {
        const std::int64_t size = std::min(batch, count - begin);
        auto* bytes =
            const_cast<std::uint8_t*>(&pictures.rgb[static_cast<std::size_t>(begin * side * side * 3)]);
        const auto images = torch::from_blob(bytes, {size, side, side, 3}, torch::kUInt8)
                                .permute({0, 3, 1, 2})
                                .to(torch::kFloat)
                                .div_(127.5)
                                .sub_(1.0)
                                .contiguous()
                                .to(device);
        latents.mean.slice(0, begin, begin + size).copy_(vae->encode_moments(images).mean);
    };
    parallel_for_batches((count + batch - 1) / batch, device.is_cpu(),
                         [&](std::int64_t first, std::int64_t end) {
                             for (auto k = first; k < end; ++k) encode(k * batch);
                         });
    latents.deviation = latents.mean.std().item<double>();
    return latents;
}

}  // namespace gse::training
