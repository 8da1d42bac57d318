// Checkpoints as files beside them, names of tensors and metadata describe them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/bundle_kind.h"
#include "engine/neural/api/checkpoint.h"
#include "engine/neural/api/lora_spec.h"
#include "engine/neural/api/model_profile.h"
#include "tests/test_paths.h"
#include "tests/unit/prompt/header_file.h"

namespace checkpoint_test {
namespace {

using namespace gse;
using namespace gse::neural;
namespace fs = std::filesystem;

using Tensors = std::vector<std::pair<std::string, std::vector<int>>>;

/// Tensors that tell the structure, and others.
Tensors checkpoint_of(int text_width, const Tensors& more = {}) {
    const std::string prefix = "model.diffusion_model.input_blocks.";
    Tensors tensors{{prefix + "0.0.weight", {320, 4, 3, 3}},
                    {prefix + "1.1.transformer_blocks.0.attn2.to_k.weight", {320, text_width}}};
    if (text_width == 1024) tensors.push_back({prefix + "1.1.proj_in.weight", {320, 320}});
    tensors.insert(tensors.end(), more.begin(), more.end());
    return tensors;
}

/// Folder with one checkpoint.
struct Checkpoint {
    test::ScratchFolder scratch;
    fs::path path;
    explicit Checkpoint(const Tensors& tensors, const nlohmann::json& metadata = {},
                        const char* name = "model.safetensors")
        : path(scratch.path() / name) {
        test::write_header_file(path, tensors, metadata);
    }
    const Checkpoint& beside(const char* name, const std::string& text) const {
        write_file(scratch.path() / name, text);
        return *this;
    }
    CheckpointPrediction prediction(bool second = false) const {
        return checkpoint_prediction(path, safetensors_header(path), second);
    }
    SchedulerConfig scheduler(bool second) const {
        return checkpoint_scheduler(path, safetensors_header(path), second);
    }
};

/// ldm's configuration, with a line for the parameterization.
std::string yaml(const std::string& line) {
    return "model:\n  base_learning_rate: 1.0e-4\n  target: ldm.models.diffusion.ddpm.LatentDiffusion\n"
           "  params:\n    " +
           line + "\n    linear_start: 0.00085\n    linear_end: 0.0120\n";
}

}  // namespace

DOCTEST_TEST_CASE("checkpoint: velocity is stated by the .yaml of its name") {
    const Checkpoint plain(checkpoint_of(768));
    DOCTEST_CHECK_FALSE(plain.prediction().velocity);
    DOCTEST_CHECK(plain.prediction(true).velocity);
    DOCTEST_CHECK(plain.prediction(true).source.empty());
    for (const char* line : {"parameterization: \"v\"", "parameterization: v  # velocity",
                             "  parameterization : 'v'\r", "\"parameterization\": \"v\","}) {
        const auto found = Checkpoint(checkpoint_of(768)).beside("model.yaml", yaml(line)).prediction();
        DOCTEST_CHECK_MESSAGE(found.velocity, line);
        DOCTEST_CHECK(found.source == "model.yaml");
    }
    DOCTEST_CHECK(Checkpoint(checkpoint_of(768), {}, "Model.SAFETENSORS")
                      .beside("Model.YML", yaml("parameterization: \"v\""))
                      .prediction()
                      .velocity);
    // Noise where it says so, or nothing: ldm's default.
    for (const char* line : {"parameterization: \"eps\"", "# parameterization: \"v\"", "log_every_t: 200"}) {
        const auto found = Checkpoint(checkpoint_of(1024)).beside("model.yaml", yaml(line)).prediction(true);
        DOCTEST_CHECK_MESSAGE(!found.velocity, line);
        DOCTEST_CHECK(found.source == "model.yaml");
    }
    // A file of something else, and one of another name beside two checkpoints, say nothing.
    DOCTEST_CHECK(Checkpoint(checkpoint_of(1024)).beside("model.yaml", "a: b\n").prediction(true).velocity);
    const Checkpoint other(checkpoint_of(768));
    other.beside("v2-inference-v.yaml", yaml("parameterization: \"v\""));
    DOCTEST_CHECK(other.prediction().velocity);
    other.beside("second.ckpt", "x");
    DOCTEST_CHECK_FALSE(other.prediction().velocity);
}

DOCTEST_TEST_CASE("checkpoint: velocity and zero terminal SNR are stated by tensors and metadata") {
    const Checkpoint tensor(checkpoint_of(768, {{"v_pred", {0}}}));
    DOCTEST_CHECK(tensor.prediction().velocity);
    DOCTEST_CHECK_FALSE(tensor.prediction().zero_terminal_snr);
    DOCTEST_CHECK(tensor.prediction().source == "its tensor \"v_pred\"");
    const Checkpoint both(checkpoint_of(768, {{"v_pred", {0}}, {"ztsnr", {0}}}));
    DOCTEST_CHECK((both.prediction().velocity && both.prediction().zero_terminal_snr));
    DOCTEST_CHECK(both.scheduler(false).rescale_betas_zero_snr);
    DOCTEST_CHECK(both.scheduler(false).timestep_spacing == "trailing");
    // Nothing can be said of the picture by a prediction of noise there.
    DOCTEST_CHECK_FALSE(Checkpoint(checkpoint_of(768, {{"ztsnr", {0}}})).prediction().zero_terminal_snr);
    for (const char* word : {"v", "V", "v_prediction", "v-prediction"})
        DOCTEST_CHECK_MESSAGE(
            Checkpoint(checkpoint_of(768), {{"modelspec.prediction_type", word}}).prediction().velocity,
            word);
    const Checkpoint noise(checkpoint_of(1024), {{"modelspec.prediction_type", "epsilon"}});
    DOCTEST_CHECK_FALSE(noise.prediction(true).velocity);
    DOCTEST_CHECK(noise.prediction(true).source == "its metadata");
    DOCTEST_CHECK_FALSE(
        Checkpoint(checkpoint_of(1024), {{"modelspec.architecture", "stable-diffusion-v2-512"}})
            .prediction(true)
            .velocity);
    // What stands beside the file counts first.
    DOCTEST_CHECK_FALSE(Checkpoint(checkpoint_of(768, {{"v_pred", {0}}}))
                            .beside("model.yaml", yaml("parameterization: eps"))
                            .prediction()
                            .velocity);
}

DOCTEST_TEST_CASE("checkpoint: the settings of a model follow what it states of its prediction") {
    DOCTEST_CHECK(model_kind(Checkpoint(checkpoint_of(1024)).path) == ModelKind::Sd2Velocity);
    DOCTEST_CHECK(
        model_kind(Checkpoint(checkpoint_of(1024), {{"modelspec.prediction_type", "epsilon"}}).path) ==
        ModelKind::Sd2);
    DOCTEST_CHECK(
        model_kind(Checkpoint(checkpoint_of(1024)).beside("model.yaml", yaml("use_ema: False")).path) ==
        ModelKind::Sd2);
}

DOCTEST_TEST_CASE("checkpoint: a VAE of its own, or the place of the one beside it") {
    DOCTEST_CHECK(has_own_vae(safetensors_header(
        Checkpoint(checkpoint_of(768, {{"first_stage_model.decoder.conv_in.weight", {512, 4, 3, 3}}}))
            .path)));
    const Checkpoint without(checkpoint_of(768));
    DOCTEST_CHECK_FALSE(has_own_vae(safetensors_header(without.path)));
    DOCTEST_CHECK(vae_beside(without.path).empty());
    DOCTEST_CHECK(vae_hint(without.path).find("model.vae.safetensors") != std::string::npos);
    write_file(without.scratch.path() / "vae/diffusion_pytorch_model.safetensors", "x");
    DOCTEST_CHECK(vae_beside(without.path).parent_path().filename() == "vae");
    write_file(without.scratch.path() / "model.vae.SFT", "x");
    DOCTEST_CHECK(vae_beside(without.path).filename() == "model.vae.SFT");
}

DOCTEST_TEST_CASE("endings of weights are known in any case") {
    for (const char* name : {"a.safetensors", "a.SAFETENSORS", "a.SafeTensors", "a.sft", "a.SFT"}) {
        DOCTEST_CHECK_MESSAGE(is_safetensors_name(name), name);
        DOCTEST_CHECK_MESSAGE(is_checkpoint_name(name), name);
        DOCTEST_CHECK_MESSAGE(!is_pickle_name(name), name);
    }
    for (const char* name : {"a.ckpt", "a.CKPT", "a.pt", "a.PTH", "a.Bin"})
        DOCTEST_CHECK_MESSAGE(is_pickle_name(name), name);
    DOCTEST_CHECK(is_checkpoint_name("a.CKPT"));
    for (const char* name : {"a.ply", "safetensors", "a.sft.txt", ""})
        DOCTEST_CHECK_FALSE(is_safetensors_name(name));
    const test::ScratchFolder folder;
    for (const char* name : {"style.SAFETENSORS", "style.sft"}) {
        write_file(folder.path() / name, "x");
        DOCTEST_CHECK(find_loras({(folder.path() / name).string()}).size() == 1);
    }
    write_file(folder.path() / "style.PT", "x");
    DOCTEST_CHECK_THROWS_AS(find_loras({(folder.path() / "style.PT").string()}), Error);
}

DOCTEST_TEST_CASE("turbo: told by names, or by its structure where no name says where it is from") {
    SchedulerConfig trailing;
    trailing.class_name = "EulerDiscreteScheduler";
    trailing.timestep_spacing = "trailing";
    UNetConfig first, second;
    second.cross_attention_dim = 1024;
    second.use_linear_projection = true;
    const auto kind = [](const UNetConfig& unet, const SchedulerConfig& scheduler, Origin origin) {
        return bundle_kind(unet, scheduler, 4, {}, origin, "model");
    };
    DOCTEST_CHECK(kind(first, trailing, Origin::Unknown) == BundleKind::Plain);
    DOCTEST_CHECK(kind(first, trailing, Origin::Turbo) == BundleKind::Turbo);
    DOCTEST_CHECK(kind(second, trailing, Origin::Unknown) == BundleKind::Turbo);
    DOCTEST_CHECK(kind(second, trailing, Origin::Other) == BundleKind::Plain);
    auto large = second;
    large.sample_size = 96;
    DOCTEST_CHECK(kind(large, trailing, Origin::Unknown) == BundleKind::Plain);
    for (auto change : {+[](SchedulerConfig& s) { s.prediction_type = "v_prediction"; },
                        +[](SchedulerConfig& s) { s.rescale_betas_zero_snr = true; },
                        +[](SchedulerConfig& s) { s.timestep_spacing = "leading"; },
                        +[](SchedulerConfig& s) { s.class_name = "DDIMScheduler"; }}) {
        auto other = trailing;
        change(other);
        DOCTEST_CHECK(kind(second, other, Origin::Turbo) == BundleKind::Plain);
    }
}

DOCTEST_TEST_CASE(
    "turbo: names are those of file and folder, of a cache of downloads and of configurations") {
    const test::ScratchFolder folder;
    const auto named = [&](const char* name) {
        fs::create_directories(folder.path() / name);
        return model_origin(folder.path() / name);
    };
    DOCTEST_CHECK(named("sd-turbo") == Origin::Turbo);
    DOCTEST_CHECK(named("sd-turbo/") == Origin::Turbo);
    DOCTEST_CHECK(named("models--stabilityai--sd-turbo/snapshots/b261bac6") == Origin::Turbo);
    DOCTEST_CHECK(named("turbocharged") == Origin::Unknown);
    DOCTEST_CHECK(named("mine") == Origin::Unknown);
    write_file(folder.path() / "mine/model_index.json",
               R"({"_name_or_path": "runwayml/stable-diffusion-v1-5"})");
    DOCTEST_CHECK(named("mine") == Origin::Other);
    write_file(folder.path() / "mine/unet/config.json", R"({"_name_or_path": "stabilityai/sd-turbo"})");
    DOCTEST_CHECK(named("mine") == Origin::Turbo);
    const Checkpoint titled(checkpoint_of(1024), {{"modelspec.title", "SD Turbo"}});
    DOCTEST_CHECK(model_origin(titled.path, safetensors_header(titled.path)) == Origin::Turbo);
    const auto scheduler = titled.scheduler(true);
    DOCTEST_CHECK(scheduler.prediction_type == "epsilon");
    DOCTEST_CHECK(scheduler.timestep_spacing == "trailing");
    const Checkpoint velocity(checkpoint_of(1024, {{"v_pred", {0}}}), {}, "sd_turbo.safetensors");
    DOCTEST_CHECK(velocity.scheduler(true).class_name == "DDIMScheduler");
}

}  // namespace checkpoint_test
