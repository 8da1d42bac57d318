// Starting weights of a training run: drawn from the seed, or those of a finished starter folder.
#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/neural/weights/key_map.h"

namespace gse::training {
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

template <class Config> Config read_config(const std::filesystem::path& path) {
    return Config::from_json(read_json_file(path), path);
}

/// For each token of `vocabulary` its row in the embedding of the folder's model, or -1 for a token that is
/// new to it. Throws when that model has a token that the run has not: what it learned of a word would be
/// lost.
std::vector<std::int64_t> rows_before(const std::filesystem::path& folder,
                                      const StarterVocabulary& vocabulary) {
    const auto file = folder / "tokenizer/vocab.json";
    const auto before = read_json_file(file), now = parse_json<Json>(vocabulary.vocab_json, "the vocabulary");
    std::string lost;  // the longest is a whole word
    for (const auto& token : before.items())
        if (token.key().ends_with("</w>") && !now.contains(token.key()) && token.key().size() > lost.size())
            lost = token.key();
    if (!lost.empty())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the initial model knows \"{}\", which this run does not train",
                                lost.substr(0, lost.size() - 4)),
                    StructureHint, file);
    std::vector<std::int64_t> rows(now.size(), -1);
    for (const auto& [token, id] : now.items())
        if (before.contains(token)) rows.at(id.get<std::size_t>()) = before.at(token).get<std::int64_t>();
    return rows;
}

/// The run's text configuration with the vocabulary of the model it goes on from.
TextEncoderConfig with_words_of(TextEncoderConfig config, const TextEncoderConfig& before) {
    config.vocab_size = before.vocab_size;
    config.bos_token_id = before.bos_token_id;
    config.eos_token_id = before.eos_token_id;
    return config;
}

/// Copies all parameters; token embeddings row by row, those of new tokens staying as they are.
void take_over(torch::nn::Module& to, const torch::nn::Module& from, const std::vector<std::int64_t>& rows) {
    const torch::NoGradGuard no_grad;
    const auto before = from.named_parameters();
    for (auto& item : to.named_parameters()) {
        const auto& old = before[item.key()];
        if (item.key().ends_with("token_embedding.weight")) {
            for (std::size_t row = 0; row < rows.size(); ++row)
                if (rows[row] >= 0) item.value()[static_cast<std::int64_t>(row)].copy_(old[rows[row]]);
        } else {
            item.value().copy_(old);
        }
    }
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

template <class Module> void fill(Module& module, const std::filesystem::path& path, const LoadPlan& plan) {
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

ClipModel initial_clip(const std::filesystem::path& folder, const ClipConfig& config,
                       const StarterVocabulary& vocabulary) {
    ClipModel clip(config);
    const auto weights = folder / "clip/model.safetensors";
    if (folder.empty() || !std::filesystem::exists(weights)) return clip;
    auto before = config;
    const auto found = read_config<ClipConfig>(folder / "clip/config.json");
    before.text = with_words_of(config.text, found.text);
    expect_same(found.to_json(), before.to_json(), folder / "clip/config.json");
    ClipModel initial(before);
    fill(initial, weights, clip_plan());
    take_over(*clip, *initial, rows_before(folder, vocabulary));
    return clip;
}

StarterParts initial_parts(const std::filesystem::path& folder, const StarterConfigs& configs,
                           const StarterVocabulary& vocabulary) {
    auto vae = read_config<VaeConfig>(folder / "vae/config.json");
    const double scaling_factor = std::exchange(vae.scaling_factor, configs.vae.scaling_factor);
    expect_same(vae.to_json(), configs.vae.to_json(), folder / "vae/config.json");
    const auto found = read_config<TextEncoderConfig>(folder / "text_encoder/config.json");
    const auto before = with_words_of(configs.text, found);
    expect_same(found.to_json(), before.to_json(), folder / "text_encoder/config.json");
    expect_same(read_config<UNetConfig>(folder / "unet/config.json").to_json(), configs.unet.to_json(),
                folder / "unet/config.json");
    StarterParts parts = fresh_parts(configs, 0);
    fill(parts.vae, folder / "vae/diffusion_pytorch_model.safetensors", vae_plan(false));
    ClipTextEncoder text(before);
    fill(text, folder / "text_encoder/model.safetensors", text_encoder_plan());
    take_over(*parts.networks.text, *text, rows_before(folder, vocabulary));
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

}  // namespace gse::training
