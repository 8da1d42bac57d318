// Checkpoints of one file: prediction, VAE and tokenizer that stand in or beside it, and its ending.
#include "engine/base/json.h"
#include "engine/neural/model.h"
#include "engine/neural/weights/key_map.h"
#include "tests/unit/neural/tiny_model.h"

namespace checkpoint_files_test {
namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

/// Tensors of a network under the names of a plan.
NamedTensors renamed(const NamedTensors& tensors, const LoadPlan& plan) {
    NamedTensors result;
    for (const auto& [name, tensor] : tensors) result.emplace_back(plan.map(name).key, tensor);
    return result;
}

/// The tiny model as a checkpoint with its configurations and the tokenizer beside it.
struct TinyCheckpoint {
    TinyModel model;
    ScratchFolder scratch;
    NamedTensors tensors, vae;  // of UNet and text encoder, and of the VAE

    TinyCheckpoint() {
        tensors = renamed(model.unet, single_file_unet_plan(tiny_unet_config()));
        const auto text =
            renamed(model.text, single_file_text_plan(tiny_text_config(), SingleFileText::Transformers));
        tensors.insert(tensors.end(), text.begin(), text.end());
        vae = renamed(model.vae, single_file_vae_plan(tiny_vae_config()));
        write_file(file("unet_config.json"), tiny_unet_config().to_json().dump());
        write_file(file("vae_config.json"), tiny_vae_config().to_json().dump());
        write_file(file("text_encoder_config.json"), tiny_text_config().to_json().dump());
        std::filesystem::copy(model.path() / "tokenizer", file("tokenizer"),
                              std::filesystem::copy_options::recursive);
    }
    std::filesystem::path file(const char* name) const { return scratch.path() / name; }
    NamedTensors whole() const {
        auto all = tensors;
        all.insert(all.end(), vae.begin(), vae.end());
        return all;
    }
    std::filesystem::path write(const NamedTensors& all, const char* name = "model.safetensors",
                                const std::map<std::string, std::string>& metadata = {}) const {
        write_safetensors(file(name), all, metadata);
        return file(name);
    }
};

bool same_vae(const ModelBundle& bundle, const TinyCheckpoint& checkpoint) {
    const auto parameters = bundle.vae->named_parameters();
    return std::all_of(checkpoint.model.vae.begin(), checkpoint.model.vae.end(), [&](const auto& weight) {
        return torch::equal(*parameters.find(weight.first), weight.second);
    });
}

}  // namespace

DOCTEST_TEST_CASE("checkpoint: velocity and zero terminal SNR as it states them") {
    const TinyCheckpoint checkpoint;
    const auto path = checkpoint.write(checkpoint.whole());
    DOCTEST_CHECK(load_bundle(path).schedule.prediction() == Prediction::Epsilon);
    DOCTEST_CHECK(describe_model(path).prediction == "epsilon");

    checkpoint.write(checkpoint.whole(), "model.safetensors", {{"modelspec.prediction_type", "v"}});
    DOCTEST_CHECK(load_bundle(path).schedule.prediction() == Prediction::Velocity);

    auto marked = checkpoint.whole();
    marked.emplace_back("v_pred", torch::zeros({0}));
    checkpoint.write(marked);
    const auto velocity = load_bundle(path);
    DOCTEST_CHECK(velocity.schedule.prediction() == Prediction::Velocity);
    DOCTEST_CHECK(velocity.schedule.alpha_cumprod(999) > 0);
    marked.emplace_back("ztsnr", torch::zeros({0}));
    checkpoint.write(marked);
    DOCTEST_CHECK(load_bundle(path).schedule.alpha_cumprod(999) == 0);

    checkpoint.write(checkpoint.whole());
    write_file(checkpoint.file("model.yaml"),
               "model:\n  params:\n    parameterization: \"v\"\n    linear_start: 0.00085\n");
    DOCTEST_CHECK(load_bundle(path).schedule.prediction() == Prediction::Velocity);
    DOCTEST_CHECK(describe_model(path).prediction == "v_prediction");
    SchedulerConfig stated;
    write_file(checkpoint.file("scheduler_config.json"), stated.to_json().dump());
    DOCTEST_CHECK(load_bundle(path).schedule.prediction() == Prediction::Epsilon);
}

DOCTEST_TEST_CASE("checkpoint: one without VAE says so, and takes the one beside it") {
    const TinyCheckpoint checkpoint;
    const auto path = checkpoint.write(checkpoint.tensors);
    try {
        load_bundle(path);
        DOCTEST_FAIL_CHECK("it was loaded");
    } catch (const Error& error) {
        DOCTEST_CHECK(contains(error.message(), "no VAE"));
        DOCTEST_CHECK(contains(error.hint(), "model.vae.safetensors"));
    }
    // As a checkpoint names it, without that prefix, and in diffusers' names.
    NamedTensors bare;
    const std::string prefix = "first_stage_model.";
    for (const auto& [name, tensor] : checkpoint.vae) bare.emplace_back(name.substr(prefix.size()), tensor);
    bare.emplace_back("loss.logvar", torch::zeros({1}));
    for (const auto& vae : {checkpoint.vae, bare, checkpoint.model.vae}) {
        checkpoint.write(vae, "model.vae.safetensors");
        const auto bundle = load_bundle(path);
        DOCTEST_CHECK(same_vae(bundle, checkpoint));
        DOCTEST_REQUIRE(bundle.notes.size() == 1);
        DOCTEST_CHECK(contains(bundle.notes.front(), "model.vae.safetensors"));
    }
    checkpoint.write({{"something", torch::zeros({1})}}, "model.vae.safetensors");
    DOCTEST_CHECK(contains(message_of([&] { load_bundle(path); }), "no VAE of Stable Diffusion"));
    std::filesystem::remove(checkpoint.file("model.vae.safetensors"));
    std::filesystem::copy(checkpoint.model.path() / "vae", checkpoint.file("vae"),
                          std::filesystem::copy_options::recursive);
    DOCTEST_CHECK(same_vae(load_bundle(path), checkpoint));
}

DOCTEST_TEST_CASE("checkpoint: endings in capitals and .sft are those of safetensors, .CKPT is a pickle") {
    const TinyCheckpoint checkpoint;
    for (const char* name : {"MODEL.SAFETENSORS", "model.sft", "model.SFT"})
        DOCTEST_CHECK(load_bundle(checkpoint.write(checkpoint.whole(), name)).image_size() == 32);
    write_file(checkpoint.file("MODEL.CKPT"), "\x80\x02}q");
    DOCTEST_CHECK(contains(message_of([&] { load_bundle(checkpoint.file("MODEL.CKPT")); }), "pickled"));
}

DOCTEST_TEST_CASE("checkpoint: a tokenizer.json beside it does for merges.txt") {
    const TinyCheckpoint checkpoint;
    const auto path = checkpoint.write(checkpoint.whole());
    const auto expected = load_bundle(path).token_ids({"a red bear with a hat"});
    nlohmann::json vocabulary, merges = nlohmann::json::array();
    const Tokenizer tokenizer(checkpoint.file("tokenizer"));
    DOCTEST_REQUIRE(tokenizer.vocabulary_size() == tiny_text_config().vocab_size);
    // Every token that the sentence needs: letters, merges, start and end, under the numbers that they have.
    for (const char* word : {"a", "red", "bear", "with", "hat"}) {
        const std::string text = word;
        for (std::size_t i = 0; i < text.size(); ++i) {
            const auto alone = tokenizer.tokenize(text.substr(i, 1));
            vocabulary[text.substr(i, 1) + "</w>"] = alone.front().id;
            vocabulary[text.substr(i, 1)] = alone.front().id - 256;
        }
        if (const auto whole = tokenizer.tokenize(text); whole.size() == 1)
            vocabulary[text + "</w>"] = whole[0].id;
    }
    vocabulary["<|startoftext|>"] = tokenizer.bos();
    vocabulary["<|endoftext|>"] = tokenizer.eos();
    for (const auto& pair :
         {std::pair{"r", "e"}, std::pair{"re", "d</w>"}, std::pair{"h", "a"}, std::pair{"ha", "t</w>"},
          std::pair{"b", "e"}, std::pair{"a", "r</w>"}, std::pair{"be", "ar</w>"}})
        merges.push_back({pair.first, pair.second});
    std::filesystem::remove(checkpoint.file("tokenizer/merges.txt"));
    write_file(
        checkpoint.file("tokenizer/tokenizer.json"),
        nlohmann::json{
            {"model",
             {{"type", "BPE"}, {"end_of_word_suffix", "</w>"}, {"vocab", vocabulary}, {"merges", merges}}}}
            .dump());
    DOCTEST_CHECK(torch::equal(load_bundle(path).token_ids({"a red bear with a hat"}), expected));
}

DOCTEST_TEST_CASE("schedule: with zero terminal SNR the last level is pure noise and the first stays") {
    SchedulerConfig config;
    config.prediction_type = "v_prediction";
    const NoiseSchedule plain(config);
    config.rescale_betas_zero_snr = true;
    DOCTEST_CHECK(SchedulerConfig::from_json(config.to_json(), "x").rescale_betas_zero_snr);
    const NoiseSchedule rescaled(config);
    DOCTEST_CHECK(rescaled.alpha_cumprod(999) == 0);
    // Roots of the products are stretched linearly (Lin et al. 2024, algorithm 1).
    constexpr double Tolerance = 1e-5;  // fp32, a product of 1000 factors
    const auto root = [](const NoiseSchedule& schedule, std::int64_t t) {
        return std::sqrt(static_cast<double>(schedule.alpha_cumprod(t)));
    };
    const double first = root(plain, 0), last = root(plain, 999);
    for (std::int64_t t = 0; t < 1000; ++t)
        DOCTEST_CHECK(std::abs(root(rescaled, t) - (root(plain, t) - last) * first / (first - last)) <=
                      Tolerance);
}

DOCTEST_TEST_CASE("samplers: every one walks from pure noise to the picture with zero terminal SNR") {
    for (const char* prediction : {"v_prediction", "epsilon"}) {
        SchedulerConfig config;
        config.prediction_type = prediction;
        config.rescale_betas_zero_snr = true;
        config.timestep_spacing = "trailing";
        const NoiseSchedule schedule(config);
        const auto target = torch::randn({1, 4, 4, 4});
        using enum SamplerKind;
        for (const auto kind : {Ddim, Euler, EulerAncestral, Pndm, DpmSolverPp2M, Ddpm}) {
            const auto sampler = make_sampler(kind, schedule, 20);
            DOCTEST_CHECK(sampler->timestep(0) == 999);
            auto x = torch::randn({1, 4, 4, 4}) * sampler->initial_sigma();
            for (std::int64_t i = 0; i < sampler->step_count(); ++i) {
                const auto t =
                    torch::full({1}, static_cast<std::int64_t>(sampler->timestep(i)), torch::kInt64);
                const auto in = sampler->scale_input(x, i);
                const double a = schedule.alpha_cumprod(t.item<std::int64_t>());
                const auto noise = (in - std::sqrt(a) * target) / std::sqrt(1 - a);
                const auto output = std::string(prediction) == "epsilon"
                                        ? noise
                                        : std::sqrt(a) * noise - std::sqrt(1 - a) * target;
                x = sampler->step(output, x, i, torch::randn_like(x));
            }
            // The last step of some leaves a little noise, as without the rescaling.
            constexpr double Leftover = 0.4;
            const double error = (x - target).abs().max().item<double>();
            DOCTEST_CHECK_MESSAGE(error < Leftover, prediction, " ", static_cast<int>(kind), ": ", error);
        }
    }
}

}  // namespace checkpoint_files_test
