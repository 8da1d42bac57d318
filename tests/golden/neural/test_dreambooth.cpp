// DreamBooth's training step against the reference: losses, gradients, clipping, AdamW, with and without
// prior and text encoder.
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the case's README.
constexpr double LossTolerance = 1e-5;                 // relative
constexpr double MeanShare = 1e-3, WorstShare = 0.05;  // of the learning rate, weights after some steps
constexpr double NormTolerance = 1e-3;                 // relative, how far each parameter moved
constexpr double IgnoredShare = 1e-2;                  // of the median: parameters without a true gradient
constexpr double ClassLatentTolerance = 2e-5;
template <class Holder, class Config>
Holder loaded(const GoldenCase& golden, const std::string& file, const LoadPlan& plan) {
    Holder module(Config::from_json(golden.json("config.json"), golden.folder));
    load_weights(*module, golden.tensors(file), plan);
    for (auto& parameter : module->parameters()) parameter.set_requires_grad(false);
    return module;
}

/// Everything the case starts from. The tokenizer is not used: the ids are given.
struct Setup {
    Setup()
        : golden("dreambooth"), unet("unet_sd1"), vae("vae"), text("clip_text_sd1"),
          pipeline("pipeline_sd1") {
        if (present()) stated = golden.json("case.json");
    }
    bool present() const {
        return golden.present && unet.present && vae.present && text.present && pipeline.present;
    }
    /// Parameters that case.json states of the run.
    DreamBoothParameters parameters() const {
        DreamBoothParameters parameters;
        parameters.learning_rate = stated.at("learning_rate").get<double>();
        parameters.prior_weight = stated.at("prior_weight").get<double>();
        parameters.max_grad_norm = stated.at("max_grad_norm").get<double>();
        parameters.weight_decay = stated.at("weight_decay").get<double>();
        return parameters;
    }
    NoiseSchedule schedule() const {
        const auto path = pipeline.folder / "scheduler/scheduler_config.json";
        return NoiseSchedule(SchedulerConfig::from_json(read_json_file(path), path));
    }
    ModelBundle bundle() const {
        const auto vae_file = vae.tensors("diffusion_pytorch_model.safetensors");
        return {
            golden.folder,
            Tokenizer(pipeline.folder / "tokenizer"),
            loaded<ClipTextEncoder, TextEncoderConfig>(text, "model.safetensors", text_encoder_plan()),
            loaded<UNet, UNetConfig>(unet, "diffusion_pytorch_model.safetensors", unet_plan()),
            loaded<AutoencoderKl, VaeConfig>(vae, "diffusion_pytorch_model.safetensors", vae_plan(vae_file)),
            schedule(),
            {}};
    }
    GoldenCase golden, unet, vae, text, pipeline;
    Json stated;
};

/// Rows [first, first + count) of step `s`.
TuningBatch rows_of(const SafetensorsFile& io, const torch::Tensor& latents, std::int64_t s,
                    std::pair<std::int64_t, std::int64_t> rows) {
    const auto [first, count] = rows;
    return {io.tensor("input_ids").narrow(0, first, count), latents.narrow(0, first, count),
            io.tensor("noise")[s].narrow(0, first, count), io.tensor("timesteps")[s].narrow(0, first, count)};
}

torch::Tensor named(const NamedTensors& tensors, const std::string& name) {
    for (const auto& [key, tensor] : tensors)
        if (key == name) return tensor;
    return {};
}

void check_weights_after(Margins& margins, const std::string& at, const NamedTensors& trained,
                         const Setup& setup) {
    const auto io = setup.golden.tensors();
    const double rate = setup.parameters().learning_rate;
    std::size_t checked = 0;
    const auto compare = [&](const std::string& what, const torch::Tensor& actual,
                             const torch::Tensor& expected) {
        margins.near(at + what, actual, expected, WorstShare * rate);
        margins.near(at + what + " mean", (actual.detach() - expected).abs().mean(), torch::zeros({}),
                     MeanShare * rate);
        ++checked;
    };
    for (const auto& [key, entry] : io.entries()) {
        if (!key.starts_with(at)) continue;
        const auto name = key.substr(at.size());
        if (const auto tensor = named(trained, name); tensor.defined()) compare(name, tensor, io.tensor(key));
    }
    if (io.contains(at + "text.token_embedding.values")) {
        const auto table = named(trained, "text.text_model.embeddings.token_embedding.weight").detach();
        compare("token rows", table.index_select(0, io.tensor(at + "text.token_embedding.rows")),
                io.tensor(at + "text.token_embedding.values"));
        compare("untouched row", table[0], io.tensor(at + "text.token_embedding.untouched_row0"));
    }
    DOCTEST_CHECK(checked > 0);
}

void check_distances(Margins& margins, const std::string& at, const NamedTensors& trained, const Setup& setup,
                     const UNet& start) {
    const auto order = setup.golden.json("unet_parameter_order.json");
    const auto expected = setup.golden.tensors().tensor(at + "unet.delta_norm_per_tensor");
    const double ignored = IgnoredShare * expected.median().item<double>();
    std::map<std::string, torch::Tensor> before;
    for (const auto& item : start->named_parameters()) before.emplace(item.key(), item.value());
    DOCTEST_REQUIRE(static_cast<std::int64_t>(order.size()) == expected.numel());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto key = order[i].get<std::string>();
        const double norm = expected[static_cast<std::int64_t>(i)].item<double>();
        if (norm < ignored) continue;
        const auto moved = (named(trained, "unet." + key).detach() - before.at(key)).norm();
        margins.near("moved " + key, moved, torch::tensor(norm), NormTolerance * norm);
    }
}

void check_step(Margins& margins, const std::string& at, const TuningStep& step, const SafetensorsFile& io) {
    const auto near = [&](const char* what, double value) {
        if (!io.contains(at + what)) return;
        const auto expected = io.tensor(at + what);
        margins.near(at + what, torch::tensor(static_cast<float>(value)), expected,
                     LossTolerance * largest(expected));
    };
    near("loss", step.loss);
    near("instance_loss", step.instance_loss);
    near("prior_loss", step.prior_loss);
}

void check_variant(const std::string& variant, bool prior, bool text, int threads) {
    const Setup setup;
    if (!setup.present()) return;
    Margins margins("dreambooth " + variant);
    const auto bundle = setup.bundle();
    const auto io = setup.golden.tensors();
    auto parameters = setup.parameters();
    parameters.train_text_encoder = text;
    parameters.threads = threads;
    DreamBoothTrainer trainer(bundle, parameters);
    const double latent_factor = setup.stated.at("latent_factor").get<double>();
    margins.near("alphas_cumprod", bundle.schedule.alphas_cumprod(), io.tensor("alphas_cumprod"),
                 CumprodTolerance);
    const auto moments = bundle.vae->encode_moments(io.tensor("pixel_values"));
    const auto steps = io.tensor("timesteps").size(0), batch = io.tensor("timesteps").size(1);
    for (std::int64_t s = 0; s < steps; ++s) {
        const auto latents = (moments.sample(io.tensor("posterior_eps")[s]) * latent_factor).detach();
        const std::string at = variant + ".step" + std::to_string(s + 1) + ".";
        if (io.contains(at + "latents"))
            margins.near("latents", latents, io.tensor(at + "latents"), ClassLatentTolerance);
        const auto instance =
            rows_of(io, latents, s,
                    prior ? std::pair{std::int64_t{0}, batch / 2} : std::pair{std::int64_t{0}, batch});
        const auto class_half = rows_of(io, latents, s, {batch / 2, batch / 2});
        auto step = trainer.accumulate(instance, prior ? &class_half : nullptr);
        check_step(margins, at, step, io);
        for (const auto& [key, entry] : io.entries())
            if (key.starts_with(at + "grad.")) {
                const auto tensor = named(trainer.trained(), key.substr(at.size() + 5));
                DOCTEST_REQUIRE_MESSAGE(tensor.defined(), key);
                margins.near_relative(key, tensor.grad(), io.tensor(key), GradientTolerance);
            }
        trainer.apply(step);
        DOCTEST_CHECK(!step.skipped);
        margins.near(at + "grad_norm", torch::tensor(static_cast<float>(step.gradient_norm)),
                     io.tensor(at + "grad_norm"), GradientTolerance * largest(io.tensor(at + "grad_norm")));
        const std::string after = variant + ".after" + std::to_string(s + 1) + ".";
        if (!io.contains(after + "unet.delta_norm_per_tensor")) continue;
        check_weights_after(margins, after, trainer.trained(), setup);
        check_distances(margins, after, trainer.trained(), setup, bundle.unet);
    }
}

}  // namespace

DOCTEST_TEST_CASE("dreambooth: UNet with prior preservation, halves one after the other and side by side") {
    check_variant("unet", true, false, 1);
    check_variant("unet", true, false, 2);
}

DOCTEST_TEST_CASE("dreambooth: UNet and text encoder") { check_variant("unet_text", true, true, 1); }

DOCTEST_TEST_CASE("dreambooth: without prior preservation") { check_variant("noprior", false, false, 1); }
