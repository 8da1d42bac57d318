// UNet, VAE, text encoder and CLIP against the reference implementations: outputs, attention maps and
// gradients.
#include "engine/neural/clip/clip_model.h"
#include "engine/neural/diffusion/schedulers.h"
#include "engine/neural/diffusion/text_encoder.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/diffusion/vae.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the cases' README files.
constexpr double ClipSegTolerance = 2e-5;  // of the largest value, at least of 1
constexpr double MapTolerance = 5e-6;
constexpr double ClipGradientRelative = 1e-4;  // of each value ...
constexpr double ClipGradientAbsolute = 1e-5;  // ... plus this share of the largest

/// All "grad.<parameter>" tensors of `io` against the parameters' gradients.
void check_parameter_gradients(Margins& margins, const torch::nn::Module& module, const SafetensorsFile& io) {
    const auto parameters = module.named_parameters();
    std::size_t compared = 0;
    for (const auto& [name, entry] : io.entries()) {
        const auto key = gradient_key(name);
        if (key.empty()) continue;
        const auto* parameter = parameters.find(key);
        DOCTEST_REQUIRE_MESSAGE(parameter != nullptr, key);
        margins.near_relative(name, parameter->grad(), io.tensor(name), GradientTolerance);
        ++compared;
    }
    DOCTEST_CHECK(compared > 0);
}

void check_maps(Margins& margins, const GoldenCase& golden, const AttentionCapture& capture) {
    const auto order = golden.json("attn_order.json");
    const auto maps = golden.tensors("attn_maps.safetensors");
    DOCTEST_REQUIRE(order.is_array());
    DOCTEST_REQUIRE(capture.maps.size() == maps.entries().size());
    for (std::size_t i = 0; i < capture.maps.size(); ++i) {
        const auto& map = capture.maps[i];
        const std::string name = order[i]["name"].get<std::string>();
        DOCTEST_CHECK(map.layer == name);
        margins.near(name, map.probabilities.narrow(0, 0, 1), maps.tensor(name), MapTolerance);
        DOCTEST_CHECK(map.height * map.width == map.probabilities.size(2));
    }
}

void check_unet(const std::string& name) {
    const GoldenCase golden(name);
    if (!golden.present) return;
    Margins margins(name);
    const auto config = UNetConfig::from_json(golden.json("config.json"), golden.folder / "config.json");
    UNet unet(config);
    load_weights(*unet, golden.tensors("diffusion_pytorch_model.safetensors"), unet_plan());
    const auto io = golden.tensors();
    auto sample = io.tensor("sample"), context = io.tensor("encoder_hidden_states");
    {
        const torch::NoGradGuard no_grad;
        AttentionCapture capture;
        margins.near("out_t0", unet->forward(sample, io.tensor("t0"), context, &capture), io.tensor("out_t0"),
                     OutputTolerance);
        check_maps(margins, golden, capture);
        margins.near(
            "out_odd",
            unet->forward(io.tensor("sample_odd"), io.tensor("t0"), io.tensor("encoder_hidden_states_odd")),
            io.tensor("out_odd"), OutputTolerance);
        const auto projection = unet->time_projection(io.tensor("t1"), sample.size(0));
        margins.near("time_proj_t1", projection, io.tensor("time_proj_t1"), OutputTolerance);
        margins.near("time_embedding_t1", unet->time_embedding(projection), io.tensor("time_embedding_t1"),
                     OutputTolerance);
    }
    sample.requires_grad_(true);
    context.requires_grad_(true);
    const auto output = unet->forward(sample, io.tensor("t1"), context);
    margins.near("out_t1", output, io.tensor("out_t1"), OutputTolerance);
    (output * io.tensor("G")).sum().backward();
    margins.near_relative("grad_sample", sample.grad(), io.tensor("grad_sample"), GradientTolerance);
    margins.near_relative("grad_encoder_hidden_states", context.grad(),
                          io.tensor("grad_encoder_hidden_states"), GradientTolerance);
    check_parameter_gradients(margins, *unet, io);
    if (!io.contains("v.pred_x0_t1")) return;
    const auto scheduler = golden.folder / "scheduler_config.json";
    const NoiseSchedule schedule(SchedulerConfig::from_json(read_json_file(scheduler), scheduler));
    const auto v = io.tensor("out_t1"), x = io.tensor("sample"), t = io.tensor("t1");
    margins.near("v.pred_x0_t1", schedule.to_x0(v, x, t), io.tensor("v.pred_x0_t1"), OutputTolerance);
    margins.near("v.pred_eps_t1", schedule.to_epsilon(v, x, t), io.tensor("v.pred_eps_t1"), OutputTolerance);
    margins.near("v.target", schedule.velocity(x, io.tensor("G"), t),
                 io.tensor("v.target_from_x_as_x0_and_G_as_noise"), OutputTolerance);
}

void check_encoder(Margins& margins, const AutoencoderKl& vae, const SafetensorsFile& io) {
    auto image = io.tensor("image").requires_grad_(true);
    const auto moments = vae->encode_moments(image);
    margins.near("mean", moments.mean, io.tensor("mean"), OutputTolerance);
    margins.near("logvar", moments.logvar, io.tensor("logvar"), OutputTolerance);
    const auto sample = moments.sample(io.tensor("eps"));
    margins.near("sample", sample, io.tensor("sample"), OutputTolerance);
    margins.near("latents_scaled", sample * vae->config().scaling_factor, io.tensor("latents_scaled"),
                 OutputTolerance);
    (moments.mean * io.tensor("G")).sum().backward({}, true);
    margins.near_relative("grad_image_of_mean", image.grad(), io.tensor("grad_image_of_mean"),
                          GradientTolerance);
    image.mutable_grad() = torch::Tensor();
    (sample * io.tensor("G")).sum().backward();
    margins.near_relative("grad_image_of_sample", image.grad(), io.tensor("grad_image_of_sample"),
                          GradientTolerance);

    const torch::NoGradGuard no_grad;
    std::vector<torch::Tensor> trace;
    vae->encoder_half()->forward(image.narrow(0, 0, 1), &trace);
    margins.near("enc.conv_in", trace.front(), io.tensor("enc.conv_in"), OutputTolerance);
    for (std::size_t i = 1; i + 1 < trace.size(); ++i) {
        const auto key = "enc.down_blocks." + std::to_string(i - 1);
        margins.near(key, trace[i], io.tensor(key), OutputTolerance);
    }
    margins.near("enc.mid_block", trace.back(), io.tensor("enc.mid_block"), OutputTolerance);
    margins.near("mean_odd", vae->encode_moments(io.tensor("image_odd")).mean, io.tensor("mean_odd"),
                 OutputTolerance);
}

void check_decoder(Margins& margins, AutoencoderKl& vae, const SafetensorsFile& io) {
    vae->zero_grad();
    auto z = io.tensor("z").requires_grad_(true);
    const auto decoded = vae->decode(z);
    margins.near("decoded", decoded, io.tensor("decoded"), OutputTolerance);
    (decoded * io.tensor("H")).sum().backward();
    margins.near_relative("grad_latent_of_decoded", z.grad(), io.tensor("grad_latent_of_decoded"),
                          GradientTolerance);
    check_parameter_gradients(margins, *vae, io);
    margins.near("decoded_odd", vae->decode(io.tensor("z_odd")), io.tensor("decoded_odd"), OutputTolerance);
}

void check_vae(const std::string& name) {
    const GoldenCase golden(name), numbers("vae");
    if (!golden.present || !numbers.present) return;
    Margins margins(name);
    AutoencoderKl vae(VaeConfig::from_json(golden.json("config.json"), golden.folder / "config.json"));
    const auto file = golden.tensors("diffusion_pytorch_model.safetensors");
    load_weights(*vae, file, vae_plan(file));
    check_encoder(margins, vae, numbers.tensors());
    check_decoder(margins, vae, numbers.tensors());
}

void check_clip_gradients(Margins& margins, const ClipTextEncoder& encoder, const SafetensorsFile& io) {
    const auto parameters = encoder->named_parameters();
    const auto near = [&](const std::string& what, const torch::Tensor& actual,
                          const torch::Tensor& expected) {
        // |difference| <= relative * |expected| + absolute * max|expected|, as one scaled comparison.
        const auto allowed = expected.abs() * ClipGradientRelative + ClipGradientAbsolute * largest(expected);
        margins.near(what, (actual - expected) / allowed, torch::zeros_like(expected), 1.0);
    };
    for (const auto& [name, entry] : io.entries()) {
        const auto key = gradient_key(name);
        if (!key.empty()) near(name, parameters[key].grad(), io.tensor(name));
    }
    near("grad_token_embedding",
         parameters["text_model.embeddings.token_embedding.weight"].grad().index_select(
             0, io.tensor("grad_token_embedding.rows")),
         io.tensor("grad_token_embedding.values"));
}

void check_clip(const std::string& name) {
    const GoldenCase golden(name);
    if (!golden.present) return;
    Margins margins(name);
    ClipTextEncoder encoder(
        TextEncoderConfig::from_json(golden.json("config.json"), golden.folder / "config.json"));
    load_weights(*encoder, golden.tensors("model.safetensors"), text_encoder_plan());
    const auto io = golden.tensors();
    const auto result = encoder->forward(io.tensor("input_ids"));
    margins.near("last_hidden_state", result.last_hidden, io.tensor("last_hidden_state"), OutputTolerance);
    for (std::size_t i = 0; i < result.hidden_states.size(); ++i) {
        const auto key = "hidden_states." + std::to_string(i);
        DOCTEST_REQUIRE(io.contains(key));
        margins.near(key, result.hidden_states[i], io.tensor(key), OutputTolerance);
    }
    const auto penultimate = result.hidden_states[result.hidden_states.size() - 2];
    margins.near("penultimate_raw", penultimate, io.tensor("penultimate_raw"), OutputTolerance);
    margins.near("penultimate_final_ln", encoder->final_norm(penultimate), io.tensor("penultimate_final_ln"),
                 OutputTolerance);
    margins.near("pooler_output", result.pooled, io.tensor("pooler_output"), OutputTolerance);
    if (io.contains("text_embeds"))
        margins.near("text_embeds", result.text_embeds, io.tensor("text_embeds"), OutputTolerance);
    const auto masked = encoder->forward(io.tensor("input_ids"), io.tensor("attention_mask"));
    margins.near("last_hidden_state_masked", masked.last_hidden, io.tensor("last_hidden_state_masked"),
                 OutputTolerance);
    encoder->zero_grad();
    (result.last_hidden * io.tensor("G")).sum().backward();
    check_clip_gradients(margins, encoder, io);
}

/// CLIPSeg holds a whole CLIP: both towers, here seen through its outputs.
void check_clip_towers(const std::string& name) {
    const GoldenCase golden(name);
    if (!golden.present) return;
    Margins margins(name);
    auto json = golden.json("config.json");
    json["model_type"] = "clip";
    ClipModel clip(ClipConfig::from_json(json, golden.folder / "config.json"));
    auto plan = clip_plan();
    plan.map = [](const std::string& parameter) { return WeightSource{"clip." + clip_key(parameter)}; };
    plan.ignore = [](const std::string& key) { return key.starts_with("decoder."); };
    load_weights(*clip, golden.tensors("model.safetensors"), plan);
    const auto io = golden.tensors();
    const auto near = [&](const std::string& key, const torch::Tensor& actual) {
        const auto expected = io.tensor(key);
        margins.near(key, actual, expected, ClipSegTolerance * std::max(1.0, largest(expected)));
    };
    const auto seen = clip->vision->forward(io.tensor("pixel_values"));
    for (std::size_t i = 0; i < seen.hidden_states.size(); ++i) {
        const auto key = "vision.hidden_states." + std::to_string(i);
        if (io.contains(key)) near(key, seen.hidden_states[i]);
    }
    near("pooled_output", seen.image_embeds.expand({io.tensor("pooled_output").size(0), -1}));
    near("conditional_embeddings", clip->text->forward(io.tensor("input_ids")).text_embeds);
}

}  // namespace

DOCTEST_TEST_CASE("unet_sd1: outputs, maps and gradients") { check_unet("unet_sd1"); }
DOCTEST_TEST_CASE("unet_sd2: outputs, maps, gradients and velocity conversions") { check_unet("unet_sd2"); }
DOCTEST_TEST_CASE("vae: moments, decoding, intermediates and gradients") { check_vae("vae"); }
DOCTEST_TEST_CASE("vae_legacy_keys: the same numbers under the old names") { check_vae("vae_legacy_keys"); }
DOCTEST_TEST_CASE("clip_text_sd1: hidden states, pooled, masked and gradients") {
    check_clip("clip_text_sd1");
}
DOCTEST_TEST_CASE("clip_text_sd2: hidden states, projection, masked and gradients") {
    check_clip("clip_text_sd2");
}
DOCTEST_TEST_CASE("clipseg: both towers of the CLIP inside, with resized positions") {
    check_clip_towers("clipseg");
    check_clip_towers("clipseg_simple");
}
