// Starting weights of a training run: drawn from the seed, or those of a finished starter folder.
#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/neural/key_map.h"
#include "engine/neural/starter_stages.h"

namespace gse::neural {
namespace {

constexpr const char* StructureHint = "train with the parameters of that model, or without --initial";

/// Throws unless the folder's configuration is the run's, but for keys that training decides.
void expect_same(const Json& found, Json wanted, const std::filesystem::path& path) {
    for (const auto& [key, value] : wanted.items())
        if (found.at(key) != value)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the initial model has the \"{}\" {}, but this run trains {}", key,
                                    found.at(key).dump(), value.dump()),
                        StructureHint, path);
}

template <class Config>
Config read_config(const std::filesystem::path& path) {
    return Config::from_json(read_json_file(path), path);
}

void expect_words(const std::filesystem::path& folder, const StarterVocabulary& vocabulary) {
    if (read_json_file(folder / "tokenizer/vocab.json") != parse_json<Json>(vocabulary.vocab_json, "the vocabulary"))
        throw Error(ErrorCode::InvalidArgument, "the initial model knows other words than this run trains",
                    StructureHint, folder / "tokenizer/vocab.json");
}

bool same_weights(torch::nn::Module& one, torch::nn::Module& other) {
    const auto a = one.parameters(), b = other.parameters();
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const torch::Tensor& x, const torch::Tensor& y) { return torch::equal(x, y); });
}

void add_half(torch::nn::Module& to, torch::nn::Module& from) {
    const auto a = to.parameters(), b = from.parameters();
    for (std::size_t i = 0; i < a.size(); ++i) a[i].lerp_(b[i], 0.5);
}

template <class Module>
void fill(Module& module, const std::filesystem::path& path, const LoadPlan& plan) {
    load_weights(*module, SafetensorsFile(path), plan);
}

}  // namespace

StarterParts fresh_parts(const StarterConfigs& configs, std::uint64_t seed) {
    StarterParts parts;
    torch::manual_seed(seed);
    parts.vae = AutoencoderKl(configs.vae);
    torch::manual_seed(seed + 1);
    parts.networks = {ClipTextEncoder(configs.text), UNet(configs.unet)};
    return parts;
}

ClipModel initial_clip(const std::filesystem::path& folder, const ClipConfig& config, const StarterVocabulary& vocabulary) {
    ClipModel clip(config);
    const auto weights = folder / "clip/model.safetensors";
    if (folder.empty() || !std::filesystem::exists(weights)) return clip;
    expect_same(read_config<ClipConfig>(folder / "clip/config.json").to_json(), config.to_json(), folder / "clip/config.json");
    expect_words(folder, vocabulary);
    fill(clip, weights, clip_plan());
    return clip;
}

StarterParts initial_parts(const std::filesystem::path& folder, const StarterConfigs& configs,
                           const StarterVocabulary& vocabulary) {
    auto vae = read_config<VaeConfig>(folder / "vae/config.json");
    const double scaling_factor = std::exchange(vae.scaling_factor, configs.vae.scaling_factor);
    expect_same(vae.to_json(), configs.vae.to_json(), folder / "vae/config.json");
    expect_same(read_config<TextEncoderConfig>(folder / "text_encoder/config.json").to_json(),
                configs.text.to_json(), folder / "text_encoder/config.json");
    expect_same(read_config<UNetConfig>(folder / "unet/config.json").to_json(), configs.unet.to_json(),
                folder / "unet/config.json");
    expect_words(folder, vocabulary);
    StarterParts parts = fresh_parts(configs, 0);
    fill(parts.vae, folder / "vae/diffusion_pytorch_model.safetensors", vae_plan(false));
    fill(parts.networks.text, folder / "text_encoder/model.safetensors", text_encoder_plan());
    fill(parts.networks.unet, folder / "unet/diffusion_pytorch_model.safetensors", unet_plan());
    parts.scaling_factor = scaling_factor;
    return parts;
}

void average_networks(StarterParts& parts, StarterParts& other, const std::filesystem::path& folder) {
    const torch::NoGradGuard no_grad;
    if (!same_weights(*parts.vae, *other.vae) || parts.scaling_factor != other.scaling_factor)
        throw Error(ErrorCode::InvalidArgument, "the model to average with has another VAE",
                    "average models that were trained from one another", folder);
    add_half(*parts.networks.text, *other.networks.text);
    add_half(*parts.networks.unet, *other.networks.unet);
}

}  // namespace gse::neural
