// Kinds of models on tiny random weights: how they are told apart, how each redraws views, and what it asks
// of the networks.
#include "engine/neural/api/model_profile.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/conditioning.h"
#include "engine/neural/guidance/multi_view_editor.h"
#include "engine/neural/model.h"
#include "tests/unit/neural/tiny_model.h"
#include "tests/unit/neural/wall_views.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

UNetConfig tiny_editor_config() {
    auto config = tiny_unet_config();
    config.in_channels = 2 * config.out_channels;
    return config;
}

UNetConfig tiny_lcm_config() {
    auto config = tiny_unet_config();
    config.time_cond_proj_dim = 6;
    return config;
}

/// TAESD's structure for the tiny VAE, written as diffusers does.
TinyAutoencoderConfig write_tiny_autoencoder(const std::filesystem::path& folder,
                                             std::vector<std::int64_t> levels = {1, 1, 1}) {
    TinyAutoencoderConfig config;
    config.channels = 8;
    config.encoder_blocks = config.decoder_blocks = std::move(levels);
    torch::manual_seed(3);
    write_safetensors(folder / "diffusion_pytorch_model.safetensors", tensors_of(TinyAutoencoder(config)));
    write_file(folder / "config.json", config.to_json().dump());
    return config;
}

SchedulerConfig scheduler_of(const std::string& name, const std::string& spacing = {}) {
    SchedulerConfig config;
    config.class_name = name;
    config.timestep_spacing = spacing;
    return config;
}

UNetConfig channels(std::int64_t in, std::int64_t out) {
    UNetConfig config;
    config.in_channels = in;
    config.out_channels = out;
    return config;
}

std::uint64_t unet_passes(const std::shared_ptr<const ModelBundle>& bundle, const SdsParameters& parameters,
                          const edit::EditViewsRequest& input) {
    DiffusionViewEditor guidance(bundle, "a red bear", parameters);
    const auto before = thread_use();
    const auto targets = guidance.edit(wall_views(), input, {});
    for (const auto& image : targets.images)
        DOCTEST_CHECK(
            std::all_of(image.data.begin(), image.data.end(), [](float v) { return v >= 0 && v <= 1; }));
    return (thread_use() - before).unet;
}

std::shared_ptr<const ModelBundle> shared(ModelBundle bundle) {
    return std::make_shared<const ModelBundle>(std::move(bundle));
}

}  // namespace

DOCTEST_TEST_CASE(
    "kinds: what the configurations tell, what may be stated, and what is refused with what it is") {
    const auto ddim = scheduler_of("DDIMScheduler");
    const auto kind = [](const UNetConfig& unet, const SchedulerConfig& scheduler,
                         const std::string& stated = {}, Origin origin = Origin::Unknown) {
        return bundle_kind(unet, scheduler, 4, stated, origin, "model");
    };
    UNetConfig embeds;
    embeds.time_cond_proj_dim = 256;
    DOCTEST_CHECK(kind(UNetConfig{}, ddim) == BundleKind::Plain);
    DOCTEST_CHECK(kind(embeds, ddim) == BundleKind::Lcm);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("LCMScheduler")) == BundleKind::Lcm);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("TCDScheduler")) == BundleKind::Tcd);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("EulerDiscreteScheduler", "trailing"), {}, Origin::Turbo) ==
                  BundleKind::Turbo);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("EulerDiscreteScheduler", "trailing")) ==
                  BundleKind::Plain);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("EulerDiscreteScheduler")) == BundleKind::Plain);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("DDIMScheduler", "trailing")) == BundleKind::Plain);
    DOCTEST_CHECK(kind(channels(8, 4), ddim) == BundleKind::InstructPix2Pix);
    DOCTEST_CHECK(kind(UNetConfig{}, ddim, "turbo") == BundleKind::Turbo);
    DOCTEST_CHECK(kind(UNetConfig{}, scheduler_of("LCMScheduler"), "plain") == BundleKind::Plain);
    DOCTEST_CHECK(contains(message_of([&] { kind(UNetConfig{}, ddim, "ip2p"); }), "cannot be"));
    DOCTEST_CHECK(contains(message_of([&] { kind(channels(8, 4), ddim, "lcm"); }), "ip2p"));
    DOCTEST_CHECK(contains(message_of([&] { kind(UNetConfig{}, ddim, "fast"); }), "\"fast\""));
    DOCTEST_CHECK(contains(message_of([&] { kind(channels(9, 4), ddim); }), "inpainting"));
    DOCTEST_CHECK(contains(message_of([&] { kind(channels(5, 4), ddim); }), "depth"));
    DOCTEST_CHECK(contains(message_of([&] { kind(channels(7, 4), ddim); }), "upscaler"));
    DOCTEST_CHECK(contains(message_of([&] { kind(channels(8, 8), ddim); }), "8 channels"));
    for (std::size_t i = 0; i < BundleKindNames.size(); ++i)
        DOCTEST_CHECK(!std::string(kind_name(static_cast<BundleKind>(i))).empty());
}

DOCTEST_TEST_CASE("kinds: a model is loaded as what it is, and refused before a weight is read") {
    DOCTEST_CHECK(load_model(TinyModel("epsilon", tiny_editor_config()).path(), "cpu")->kind() ==
                  BundleKind::InstructPix2Pix);
    DOCTEST_CHECK(load_model(TinyModel("epsilon", tiny_lcm_config(), "LCMScheduler").path(), "cpu")->kind() ==
                  BundleKind::Lcm);
    auto inpainting = tiny_unet_config();
    inpainting.in_channels = 9;
    const TinyModel other("epsilon", inpainting);
    std::filesystem::resize_file(other.path() / "unet/diffusion_pytorch_model.safetensors", 3);
    DOCTEST_CHECK(contains(message_of([&] { load_bundle(other.path()); }), "inpainting"));
    const TinyModel stated;
    write_file(stated.path() / "gseditpro.json", R"({"kind": "turbo"})");
    const auto turbo = load_bundle(stated.path());
    DOCTEST_CHECK(turbo.kind == BundleKind::Turbo);
    DOCTEST_CHECK(turbo.schedule.config().timestep_spacing == "trailing");
}

DOCTEST_TEST_CASE(
    "kinds: levels of a redrawn view are those the model knows, and go down from its strength") {
    const NoiseSchedule schedule{SchedulerConfig{}};
    const auto levels = [&](BundleKind kind, double strength, int steps) {
        return redraw_levels(kind, schedule, strength, steps);
    };
    using Levels = std::vector<std::int64_t>;
    DOCTEST_CHECK(levels(BundleKind::Lcm, 1, 4) == Levels{999, 759, 499, 259});
    DOCTEST_CHECK(levels(BundleKind::Lcm, 0.8, 4) == Levels{799, 599, 399, 199});
    DOCTEST_CHECK(levels(BundleKind::Tcd, 0.5, 4) == Levels{499, 379, 259, 139});
    DOCTEST_CHECK(levels(BundleKind::Turbo, 0.75, 2) == Levels{749, 499});
    DOCTEST_CHECK(levels(BundleKind::Turbo, 0.5, 2) == Levels{499, 249});
    DOCTEST_CHECK(levels(BundleKind::Turbo, 1, 4) == Levels{999, 749, 499, 249});
    DOCTEST_CHECK(levels(BundleKind::Plain, 0.75, 3) == redraw_timesteps(0.75, 3, 1000));
    for (const auto kind : {BundleKind::Plain, BundleKind::Lcm, BundleKind::Tcd, BundleKind::Turbo,
                            BundleKind::InstructPix2Pix})
        for (const double strength : {0.02, 0.3, 0.75, 1.0})
            for (const int steps : {1, 2, 5, 30, 100}) {
                const auto some = levels(kind, strength, steps);
                DOCTEST_CAPTURE(kind_name(kind));
                DOCTEST_CAPTURE(strength);
                DOCTEST_CAPTURE(steps);
                DOCTEST_CHECK(!some.empty());
                DOCTEST_CHECK(some.size() <= static_cast<std::size_t>(steps));
                DOCTEST_CHECK(std::is_sorted(some.rbegin(), some.rend()));
                DOCTEST_CHECK(std::adjacent_find(some.begin(), some.end()) == some.end());
                DOCTEST_CHECK(static_cast<double>(some.front()) < 1000 * strength);
            }
}

DOCTEST_TEST_CASE("kinds: two rows do for InstructPix2Pix at image scale 1 what three do") {
    const TinyModel model("epsilon", tiny_editor_config());
    const auto bundle = load_bundle(model.path());
    const torch::NoGradGuard no_grad;
    torch::manual_seed(5);
    Conditioning conditioning{bundle.encode_prompts({"", "a red bear"}).unsqueeze(0), 5,
                              torch::randn({1, 4, 8, 8}), 1};
    const auto x = torch::randn({1, 4, 8, 8}), t = torch::full({1}, 400.0);
    const auto two = guided_output(bundle.unet, x, t, conditioning);
    conditioning.image_guidance_scale = 1 + 1e-9;
    DOCTEST_REQUIRE(row_parts(bundle.unet->config(), conditioning) == 3);
    const auto three = guided_output(bundle.unet, x, t, conditioning);
    constexpr double rounding = 1e-4;
    DOCTEST_CHECK((two - three).abs().max().item<double>() < rounding);
    conditioning.picture = torch::zeros_like(conditioning.picture);
    DOCTEST_CHECK((two - guided_output(bundle.unet, x, t, conditioning)).abs().max().item<double>() >
                  rounding);  // it is seen
}

DOCTEST_TEST_CASE("kinds: each redraws views with as few calls as it needs") {
    edit::EditViewsRequest input;
    input.steps = 3;
    input.strength = 0.8;
    SdsParameters parameters;
    parameters.before_prompt = "a bear";
    const TinyModel editor("epsilon", tiny_editor_config());
    const auto editing = shared(load_bundle(editor.path()));
    parameters.image_guidance_scale = 1;
    DOCTEST_CHECK(unet_passes(editing, parameters, input) == 2 * 3 * 2);  // views, steps, rows
    parameters.image_guidance_scale = 1.5;
    DOCTEST_CHECK(unet_passes(editing, parameters, input) == 2 * 3 * 3);
    parameters.delta = 0;
    const TinyModel consistency("epsilon", tiny_lcm_config(), "LCMScheduler");
    const auto embedding = shared(load_bundle(consistency.path()));
    for (const double scale : {1.0, 8.5}) {  // it is built in
        parameters.view_guidance_scale = scale;
        DOCTEST_CHECK(unet_passes(embedding, parameters, input) == 2 * 3);
    }
    const TinyModel plain;
    auto lcm = load_bundle(plain.path());
    lcm.kind = BundleKind::Lcm;
    parameters.view_guidance_scale = 1;
    DOCTEST_CHECK(unet_passes(shared(lcm), parameters, input) == 2 * 3);
    parameters.view_guidance_scale = 1.5;  // a LoRA takes ordinary guidance
    DOCTEST_CHECK(unet_passes(shared(lcm), parameters, input) == 2 * 3 * 2);
    auto diffusion = shared(load_bundle(plain.path()));
    input.guided_until = 0.5;  // of the levels 0.8, 0.53 and 0.27 the last is not guided
    DOCTEST_CHECK(unet_passes(diffusion, parameters, input) == 2 * (2 + 2 + 1));
    DOCTEST_CHECK(unet_passes(embedding, parameters, input) == 2 * 3);
    parameters.image_guidance_scale = 1;
    DOCTEST_CHECK(unet_passes(editing, parameters, input) == 2 * 3 * 2);  // its other row is the picture's
}

DOCTEST_TEST_CASE("kinds: between the steps an LCM takes fresh noise, TCD none; both repeat with the seed") {
    const TinyModel plain;
    auto bundle = load_bundle(plain.path());
    const auto redrawn = [&](BundleKind kind, std::uint64_t seed, int steps) {
        bundle.kind = kind;
        edit::EditViewsRequest input;
        input.steps = steps;
        input.seed = seed;
        SdsParameters parameters;
        parameters.delta = 0;
        return DiffusionViewEditor(shared(bundle), "a red bear", parameters)
            .edit(wall_views(), input, {})
            .images[0]
            .data;
    };
    const auto lcm = redrawn(BundleKind::Lcm, 3, 3);
    DOCTEST_CHECK(lcm == redrawn(BundleKind::Lcm, 3, 3));
    DOCTEST_CHECK(lcm != redrawn(BundleKind::Lcm, 4, 3));
    DOCTEST_CHECK(lcm != redrawn(BundleKind::Tcd, 3, 3));
    DOCTEST_CHECK(redrawn(BundleKind::Lcm, 3, 1) == redrawn(BundleKind::Tcd, 3, 1));  // nothing comes between
}

DOCTEST_TEST_CASE(
    "kinds: InstructPix2Pix keeps to the unedited view, pulls and locates; it cannot learn a scene") {
    const TinyModel editor("epsilon", tiny_editor_config());
    const auto bundle = shared(load_bundle(editor.path()));
    SdsParameters parameters;
    auto views = wall_views();
    DiffusionViewEditor guidance(bundle, "make it red", parameters);
    edit::EditViewsRequest input;
    input.steps = 2;
    const auto one = guidance.edit(views, input, {}).images[0].data;
    for (auto& view : views)
        for (auto& value : view.original.data) value = 1 - value;
    DOCTEST_CHECK(guidance.edit(views, input, {}).images[0].data != one);
    const auto model = load_model(editor.path(), "cpu");
    const auto sds = model->guidance("make it red", parameters);
    const auto gradient =
        sds->evaluate({views[0].rendered, views[0].view, 0, "", 0, 10, 7, &views[0].original}).gradient;
    DOCTEST_CHECK(
        std::all_of(gradient.data.begin(), gradient.data.end(), [](float v) { return std::isfinite(v); }));
    for (const char* method : {"probes", "img2img"}) {
        AttentionParameters attention;
        attention.method = method;
        attention.steps = 4;
        const auto maps = model->attention(attention)->locate({views[0].rendered, "a bear", {"bear"}});
        DOCTEST_REQUIRE(maps.size() == 1);
        DOCTEST_CHECK(*std::max_element(maps[0].data.begin(), maps[0].data.end()) > 0.0f);
    }
    SampleRequest request;
    request.prompt = "make it red";
    request.steps = 2;
    DOCTEST_CHECK(model->img2img(views[0].rendered, request).width == model->image_size());
    DOCTEST_CHECK(model->sample(request).width == model->image_size());
    const std::vector<Image> pictures{views[0].rendered};
    DOCTEST_CHECK(contains(message_of([&] { model->tune({}, pictures, "a * bear", "a bear", {}); }), "ip2p"));
}

DOCTEST_TEST_CASE(
    "tiny autoencoder: beside the weights, by a setting, or not; for everything but the last round") {
    const TinyModel model;
    DOCTEST_CHECK(!load_bundle(model.path()).has_tiny());
    write_tiny_autoencoder(model.path() / "taesd");
    const auto bundle = shared(load_bundle(model.path()));
    DOCTEST_REQUIRE(bundle->has_tiny());
    DOCTEST_CHECK(!load_bundle(model.path(), torch::kCPU, "none").has_tiny());
    const ScratchFolder elsewhere;
    std::filesystem::rename(model.path() / "taesd", elsewhere.path() / "small");
    DOCTEST_CHECK(!load_bundle(model.path()).has_tiny());
    DOCTEST_CHECK(load_bundle(model.path(), torch::kCPU, (elsewhere.path() / "small").string()).has_tiny());
    DOCTEST_CHECK(
        contains(message_of([&] { load_bundle(model.path(), torch::kCPU, "/not/there"); }), "TAESD"));
    write_file(model.path() / "gseditpro.json",
               "{\"taesd\": \"" + (elsewhere.path() / "small").string() + "\"}");
    DOCTEST_CHECK(load_bundle(model.path()).has_tiny());
    DOCTEST_CHECK(!load_bundle(model.path(), torch::kCPU, "none").has_tiny());
    write_tiny_autoencoder(elsewhere.path() / "large", {1, 1, 1, 1});  // 8 pixels per cell, the VAE has 4
    DOCTEST_CHECK(contains(
        message_of([&] { load_bundle(model.path(), torch::kCPU, (elsewhere.path() / "large").string()); }),
        "pixels per cell"));

    const auto config = TinyAutoencoderConfig{};
    DOCTEST_CHECK(TinyAutoencoderConfig::from_json(config.to_json(), "x").to_json() == config.to_json());
    edit::EditViewsRequest input;
    input.steps = 1;
    input.rounds = 2;
    const auto arithmetic = [&](int round) {
        input.round = round;
        DiffusionViewEditor guidance(bundle, "a red bear", {});
        const auto before = thread_use();
        guidance.edit(wall_views(), input, {});
        const auto use = thread_use() - before;
        DOCTEST_CHECK(use.encoder == 2);
        DOCTEST_CHECK(use.decoder == 2 * 2);
        return use.flop;
    };
    const auto flop_of = [&](Codec codec) {  // of one picture there and back
        const auto before = thread_use();
        latents_to_image(*bundle, image_to_latents(*bundle, torch::zeros({1, 3, 32, 32}), codec), codec);
        return (thread_use() - before).flop;
    };
    DOCTEST_CHECK(flop_of(Codec::Quick) != flop_of(Codec::Full));
    DOCTEST_CHECK(arithmetic(0) != arithmetic(1));  // the last round has the VAE's decoder
    const auto before = thread_use();
    const auto attention =
        load_model(model.path(), ModelOptions{"cpu", {}, (elsewhere.path() / "small").string()})->attention();
    attention->locate({wall_views()[0].rendered, "a bear", {"bear"}});
    DOCTEST_CHECK((thread_use() - before).encoder == 1);
}

DOCTEST_TEST_CASE(
    "profile: a kind brings its steps, rounds and guidance, also by a LoRA that was distilled") {
    const auto value = [](const ModelProfile& profile, const std::string& part, const std::string& field) {
        for (const auto& entry : profile.entries)
            if (entry.part == part && entry.field == field) return entry.value;
        return nlohmann::ordered_json();
    };
    const auto few = model_profile(TinyModel("epsilon", tiny_lcm_config(), "LCMScheduler").path());
    DOCTEST_CHECK(few.bundle == BundleKind::Lcm);
    DOCTEST_CHECK(value(few, "request", "view_steps") == 4);
    DOCTEST_CHECK(value(few, "guidance", "view_guidance_scale") == 8.5);
    const auto editor = model_profile(TinyModel("epsilon", tiny_editor_config()).path());
    DOCTEST_CHECK(editor.bundle == BundleKind::InstructPix2Pix);
    DOCTEST_CHECK(value(editor, "guidance", "image_guidance_scale") == 1.0);
    DOCTEST_CHECK(value(editor, "request", "method") == "views");
    const TinyModel plain;
    DOCTEST_CHECK(model_profile(plain.path()).entries.empty());
    write_safetensors(plain.path() / "tcd lora.safetensors",
                      {{"lora_unet_x.lora_up.weight", torch::ones({1, 1})}});
    const auto marked = model_profile(plain.path(), {{plain.path() / "tcd lora.safetensors", 1}});
    DOCTEST_CHECK(marked.bundle == BundleKind::Tcd);
    DOCTEST_CHECK(value(marked, "guidance", "view_guidance_scale") == 1.0);
    DOCTEST_CHECK(model_profile(plain.path(), {{plain.path() / "tcd lora.safetensors", 0}}).entries.empty());
}
