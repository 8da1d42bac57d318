// Which kind a model is, from its configurations or a checkpoint's shapes, and what its profile states.
#include "engine/neural/api/model_profile.h"
#include "tests/unit/neural/tiny_model.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

/// A model folder of which only the configurations are there.
struct Configured {
    ScratchFolder scratch;
    explicit Configured(const UNetConfig& unet, const std::string& prediction = "epsilon") {
        SchedulerConfig scheduler;
        scheduler.prediction_type = prediction;
        write_file(path() / "unet/config.json", unet.to_json().dump());
        write_file(path() / "scheduler/scheduler_config.json", scheduler.to_json().dump());
    }
    const std::filesystem::path& path() const { return scratch.path(); }
    void state(const std::string& json) const { write_file(path() / "gseditpro.json", json); }
};

UNetConfig sd2_config() {
    UNetConfig config;
    config.cross_attention_dim = 1024;
    config.heads = {5, 10, 20, 20};
    config.use_linear_projection = true;
    return config;
}

/// Entry of a field: its value and source; null when nothing is stated of it.
const ProfileEntry* entry_of(const ModelProfile& profile, const std::string& part, const std::string& field) {
    for (const auto& entry : profile.entries)
        if (entry.part == part && entry.field == field) return &entry;
    return nullptr;
}

Json value_of(const ModelProfile& profile, const std::string& part, const std::string& field) {
    const auto* entry = entry_of(profile, part, field);
    return entry == nullptr ? Json() : entry->value;
}

/// A checkpoint with the tensors that tell the kind.
void write_checkpoint(const std::filesystem::path& path, std::int64_t width, std::int64_t text_width,
                      bool linear) {
    const std::string prefix = "model.diffusion_model.input_blocks.";
    write_safetensors(
        path, {{prefix + "0.0.weight", torch::zeros({width, 4, 3, 3})},
               {prefix + "1.1.proj_in.weight",
                linear ? torch::zeros({width, width}) : torch::zeros({width, width, 1, 1})},
               {prefix + "1.1.transformer_blocks.0.attn2.to_k.weight", torch::zeros({width, text_width})}});
}

}  // namespace

DOCTEST_TEST_CASE("profile: kinds are told apart by their configurations") {
    const TinyModel tiny;
    DOCTEST_CHECK(model_kind(tiny.path()) == ModelKind::Small);
    DOCTEST_CHECK(model_profile(tiny.path()).entries.empty());
    DOCTEST_CHECK(model_kind(Configured(UNetConfig{}).path()) == ModelKind::Sd1);
    DOCTEST_CHECK(model_kind(Configured(sd2_config()).path()) == ModelKind::Sd2);
    DOCTEST_CHECK(model_kind(Configured(sd2_config(), "v_prediction").path()) == ModelKind::Sd2Velocity);
    auto narrow = tiny_unet_config();
    narrow.use_linear_projection = true;
    DOCTEST_CHECK(model_kind(Configured(narrow, "v_prediction").path()) == ModelKind::Small);
    // What is wrong with a model is said when it is loaded.
    const Configured broken{UNetConfig{}};
    write_file(broken.path() / "unet/config.json", "{");
    DOCTEST_CHECK(model_kind(broken.path()) == ModelKind::Small);
    DOCTEST_CHECK(model_kind(broken.path() / "nothing") == ModelKind::Small);
    DOCTEST_CHECK(model_profile(source_folder() / "assets/models/starter").entries.empty());
}

DOCTEST_TEST_CASE(
    "profile: kinds of checkpoints are told apart by shapes, and by configurations beside them") {
    const ScratchFolder scratch;
    const auto path = scratch.path() / "model.safetensors";
    write_checkpoint(path, 320, 768, false);
    DOCTEST_CHECK(model_kind(path) == ModelKind::Sd1);
    write_checkpoint(path, 320, 1024, true);
    DOCTEST_CHECK(model_kind(path) == ModelKind::Sd2Velocity);
    write_file(scratch.path() / "scheduler_config.json", SchedulerConfig{}.to_json().dump());
    DOCTEST_CHECK(model_kind(path) == ModelKind::Sd2);
    write_checkpoint(path, 32, 32, true);
    DOCTEST_CHECK(model_kind(path) == ModelKind::Small);
    write_file(path, "not a checkpoint");
    DOCTEST_CHECK(model_kind(path) == ModelKind::Small);
}

DOCTEST_TEST_CASE("profile: a kind's values, and over them those of gseditpro.json beside the weights") {
    const Configured velocity(sd2_config(), "v_prediction");
    DOCTEST_CHECK(value_of(model_profile(velocity.path()), "request", "image_size") == 768);
    const Configured model{UNetConfig{}};
    const auto built_in = model_profile(model.path());
    DOCTEST_CHECK(value_of(built_in, "request", "image_size") == 512);
    DOCTEST_CHECK(value_of(built_in, "request", "geometry_share") == 1.0);
    DOCTEST_CHECK(value_of(built_in, "guidance", "guidance_scale") == 7.5);
    DOCTEST_CHECK(value_of(built_in, "dreambooth", "learning_rate") == 5e-6);
    DOCTEST_CHECK(value_of(built_in, "job", "threads") >= 1);
    DOCTEST_CHECK(value_of(built_in, "request", "label_threshold") == 0.5);
    model.state(
        R"({"name": "mine", "profile": {"request": {"image_size": 384}, "attention": {"steps": 20}}})");
    const auto stated = model_profile(model.path());
    DOCTEST_REQUIRE(entry_of(stated, "request", "image_size") != nullptr);
    DOCTEST_CHECK(entry_of(stated, "request", "image_size")->value == 384);
    DOCTEST_CHECK(entry_of(stated, "request", "image_size")->source == "file gseditpro.json");
    DOCTEST_CHECK(entry_of(stated, "request", "label_threshold")->source == "model");
    DOCTEST_CHECK(value_of(stated, "attention", "steps") == 20);
    DOCTEST_CHECK(stated.entries.size() == built_in.entries.size() + 1);
    // A checkpoint's file is in its folder.
    write_checkpoint(model.path() / "model.safetensors", 320, 768, false);
    DOCTEST_CHECK(value_of(model_profile(model.path() / "model.safetensors"), "request", "image_size") ==
                  384);
}

DOCTEST_TEST_CASE("profile: what is stated of no setting, or out of its range, is refused by its name") {
    const Configured model{UNetConfig{}};
    const auto refusal = [&](const std::string& profile) {
        model.state(R"({"profile": )" + profile + "}");
        try {
            model_profile(model.path());
        } catch (const Error& error) {
            DOCTEST_CHECK(contains(error.what(), "gseditpro.json"));
            return error.message();
        }
        return std::string();
    };
    DOCTEST_CHECK(contains(refusal(R"({"request": {"image_sise": 512}})"), "image_sise"));
    DOCTEST_CHECK(contains(refusal(R"({"request": {"image_size": 100000}})"),
                           "\"image_size\" must be a number from 16 to 1024"));
    DOCTEST_CHECK(contains(refusal(R"({"guidance": {"clamp": "much"}})"), "\"clamp\""));
    DOCTEST_CHECK(contains(refusal(R"({"dreambooth": {"steps": -1}})"), "\"steps\""));
    DOCTEST_CHECK(contains(refusal(R"({"attention": {"steps": 0}})"), "\"steps\""));
    DOCTEST_CHECK(contains(refusal(R"({"job": {"threads": 0}})"), "\"threads\""));
    DOCTEST_CHECK(contains(refusal(R"({"job": {"device": "cuda"}})"), "device"));
    DOCTEST_CHECK(contains(refusal(R"({"request": {"prompt": "a hat"}})"), "prompt"));
    DOCTEST_CHECK(contains(refusal(R"({"sampler": {}})"), "sampler"));
    DOCTEST_CHECK(contains(refusal(R"({"request": 3})"), "\"request\""));
    DOCTEST_CHECK(contains(refusal("[]"), "\"profile\""));
}
