// Whole models that redraw pictures in other ways than Stable Diffusion: LCM, InstructPix2Pix, and the tiny
// autoencoder.
#include <fstream>

#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/bundle_folder.h"
#include "tests/golden/neural/fake_model.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the cases' README files.
constexpr double EmbeddingTolerance = 1e-3, EmbeddingTableTolerance = 2e-3;
constexpr double EmbeddedOutputTolerance = 3e-4;  // where the embedding is computed, not given
constexpr double LcmLatents = 1e-3;               // of each value, and absolute
constexpr double EditedLatents = 1e-4;            // of the largest value
constexpr double EditedImage = 2e-3;

UNet load_unet(const GoldenCase& golden) {
    UNet unet(UNetConfig::from_json(golden.json("config.json"), golden.folder / "config.json"));
    load_weights(*unet, golden.tensors("diffusion_pytorch_model.safetensors"), unet_plan());
    return unet;
}

/// "grad.<parameter><ending>" of the file against the parameters.
void check_gradients(Margins& margins, const torch::nn::Module& network, const SafetensorsFile& io,
                     const std::string& ending = {}) {
    const auto parameters = network.named_parameters();
    std::size_t compared = 0;
    for (const auto& [name, entry] : io.entries()) {
        const auto key = gradient_key(name);
        if (key.empty() || !key.ends_with(ending)) continue;
        const auto* parameter = parameters.find(key.substr(0, key.size() - ending.size()));
        DOCTEST_REQUIRE_MESSAGE(parameter != nullptr, name);
        margins.near_relative(name, parameter->grad(), io.tensor(name), GradientTolerance);
        ++compared;
    }
    DOCTEST_CHECK(compared > 0);
}

/// One of the two guidance scales: embedding, output with it given and computed, gradients.
void check_embedded_scale(Margins& margins, UNet unet, const SafetensorsFile& io, double scale,
                          const std::string& index) {
    const auto w = io.tensor("w" + index), t = io.tensor("t"), expected = io.tensor("out.w" + index);
    const auto width = unet->config().time_cond_proj_dim;
    margins.near("w" + index, torch::full_like(w, scale - 1), w, 0);
    const auto embedding = guidance_embedding(w, width), given = io.tensor("w_embedding.w" + index);
    margins.near("w_embedding.w" + index, embedding, given, EmbeddingTolerance);
    auto sample = io.tensor("sample").requires_grad_(true),
         context = io.tensor("encoder_hidden_states").requires_grad_(true);
    unet->zero_grad();
    const auto output = unet->forward(sample, t, context, nullptr, given);
    margins.near("out.w" + index, output, expected, OutputTolerance);
    (output * io.tensor("G")).sum().backward();
    margins.near_relative("grad_sample.w" + index, sample.grad(), io.tensor("grad_sample.w" + index),
                          GradientTolerance);
    margins.near_relative("grad_encoder_hidden_states.w" + index, context.grad(),
                          io.tensor("grad_encoder_hidden_states.w" + index), GradientTolerance);
    check_gradients(margins, *unet, io, ".w" + index);
    const torch::NoGradGuard no_grad;
    margins.near("computed out.w" + index, unet->forward(sample, t, context, nullptr, embedding), expected,
                 EmbeddedOutputTolerance);
    const auto both = torch::stack({context, context}, 1);  // no text against it: the scale is built in
    margins.near("guided out.w" + index, guided_output(unet, sample, t, {both, scale}), expected,
                 EmbeddedOutputTolerance);
}

/// One run of "pipeline" in lcm/case.json.
void check_lcm_run(Margins& margins, const ModelBundle& bundle, const SafetensorsFile& io,
                   const std::string& name, const Json& stated) {
    const torch::NoGradGuard no_grad;
    const auto strength = stated.at("strength").get<double>();
    const auto walk = image_to_image(
        sampler_of(bundle.kind), bundle.schedule, stated.at("steps").get<std::int64_t>(),
        {.strength = strength, .original_steps = stated.at("original_inference_steps").get<std::int64_t>()});
    margins.near(name + ".timesteps", torch::tensor(walk.sampler->timesteps()),
                 io.tensor(name + ".timesteps").to(torch::kFloat64), 0);
    const auto image = io.tensor("init_image");
    const auto moments = bundle.vae->encode_moments(image * 2 - 1);
    const bool sampled = name == "posterior_sample";
    const auto clean =
        (sampled ? moments.sample(io.tensor("posterior_eps")) : moments.mean) * bundle.scaling_factor();
    if (!sampled) margins.near(name + " mean", image_to_latents(bundle, image), clean, 0);
    const auto near = [&](const std::string& what, const torch::Tensor& actual,
                          const torch::Tensor& expected) {
        near_scaled(margins, name + what, actual, expected, LcmLatents, LcmLatents);
    };
    near(".init_latents", clean, io.tensor(name + ".init_latents"));
    const auto latents = io.tensor(name + ".latents"), denoised = io.tensor(name + ".denoised");
    const auto start = walk.sampler->start_from(clean, io.tensor("noise"), walk.first);
    near(" start", start, latents[0]);
    DenoiseJob job;
    job.sampler = walk.sampler.get();
    job.first = walk.first;
    job.guidance_scale = stated.at("guidance_scale").get<double>();
    job.context = torch::cat({io.tensor("prompt_embeds"), io.tensor("prompt_embeds")});
    job.noise = [&](std::int64_t step) { return io.tensor("step_noises")[step]; };
    job.after_step = [&](std::int64_t step, const torch::Tensor& x) {
        near(" latents", x, latents[step + 1]);
        near(" denoised", walk.sampler->predicted_x0(), denoised[step]);
    };
    margins.near(name + ".image", latents_to_image(bundle, denoise(bundle, start, job)),
                 io.tensor(name + ".image"), EditedImage);
}

/// Row of the reference's batch [text; picture; neither] that stands at `row` of ours.
std::int64_t reference_row(std::int64_t row, int parts) { return parts == 2 ? 1 - row : row; }

void check_first_call(Margins& margins, const ModelBundle& bundle, const SafetensorsFile& io,
                      const std::string& name, const DenoiseJob& job, const torch::Tensor& start) {
    const auto rows =
        unet_rows(bundle.unet->config(), job.sampler->scale_input(start, job.first),
                  {job.context.unsqueeze(0), job.guidance_scale, job.picture, job.image_guidance_scale});
    const auto t = torch::full({1}, job.sampler->timestep(job.first), torch::kFloat32);
    const auto output = bundle.unet->forward(rows.input, t, rows.context);
    const auto in = io.tensor(name + ".unet_in_0"), out = io.tensor(name + ".unet_out_0");
    // An image scale of 1 needs the first two of the reference's rows only.
    DOCTEST_CHECK(rows.parts == (job.guidance_scale > 1 && job.image_guidance_scale == 1 ? 2 : in.size(0)));
    for (std::int64_t row = 0; row < rows.parts; ++row) {
        const auto there = reference_row(row, rows.parts);
        margins.near(name + ".unet_in_0", rows.input[row], in[there], OutputTolerance * largest(in));
        margins.near(name + ".unet_out_0", output[row], out[there], OutputTolerance);
    }
}

/// One run of ip2p/case.json.
void check_instruction_run(Margins& margins, const BundleFolder& folder, const GoldenCase& golden,
                           const std::string& name, const Json& stated) {
    const torch::NoGradGuard no_grad;
    const auto scheduler = stated.at("scheduler").get<std::string>();
    const bool ddim = scheduler == "ddim";
    DOCTEST_REQUIRE_MESSAGE((ddim || scheduler == "euler_a"), scheduler);
    const auto file = golden.folder / (ddim ? "ddim_scheduler_config.json" : "scheduler_config.json");
    const auto config = SchedulerConfig::from_json(read_json_file(file), file);
    auto bundle = folder.load();
    DOCTEST_CHECK(bundle.kind == BundleKind::InstructPix2Pix);
    const auto io = golden.tensors("pipeline_io.safetensors");
    const auto sampler =
        make_sampler(sampler_kind(config), NoiseSchedule(config), stated.at("steps").get<std::int64_t>());
    margins.near(name + ".timesteps", torch::tensor(sampler->timesteps()),
                 io.tensor(name + ".timesteps").to(torch::kFloat64), 1e-4);
    DenoiseJob job;
    job.sampler = sampler.get();
    job.guidance_scale = stated.at("guidance_scale").get<double>();
    job.image_guidance_scale = stated.at("image_guidance_scale").get<double>();
    job.context = torch::cat({io.tensor("negative_prompt_embeds"), io.tensor("prompt_embeds")});
    job.picture = picture_latents(bundle, io.tensor("image_in"));
    margins.near("image_latents", job.picture, io.tensor("image_latents"), OutputTolerance);
    job.noise = [&](std::int64_t step) { return io.tensor("step_noises")[step]; };
    const auto expected = io.tensor(name + ".latents_steps");
    DOCTEST_REQUIRE(expected.size(0) == sampler->step_count());
    job.after_step = [&](std::int64_t step, const torch::Tensor& x) {
        margins.near(name + ".latents", x, expected[step], EditedLatents * largest(expected));
    };
    const auto start = io.tensor("latents_noise") * sampler->initial_sigma();
    check_first_call(margins, bundle, io, name, job, start);
    margins.near(name + ".image", latents_to_image(bundle, denoise(bundle, start, job)),
                 io.tensor(name + ".image"), EditedImage);
}

/// A ReLU whose input rounds to the other side of zero changes the gradient in its receptive field. The
/// processor's order of summation decides which ones do.
constexpr double KinkedShare = 0.02;   // elements that may be beyond the tolerance
constexpr double KinkedError = 0.005;  // of the whole gradient, relative in the Euclidean norm

void check_kinked_gradient(const torch::Tensor& actual, const torch::Tensor& expected) {
    const auto wanted = expected.to(torch::kFloat64), error = (actual.to(torch::kFloat64) - wanted).abs();
    const auto beyond = (error > GradientTolerance * largest(wanted)).to(torch::kFloat64).mean();
    DOCTEST_CHECK(beyond.item<double>() <= KinkedShare);
    DOCTEST_CHECK((error.norm() / wanted.norm()).item<double>() <= KinkedError);
}

/// In double precision no input of a ReLU is near enough to zero to matter.
void check_exact_gradient(Margins& margins, TinyAutoencoder tiny, const SafetensorsFile& io) {
    tiny->to(torch::kFloat64);
    const auto image = io.tensor("image").to(torch::kFloat64).requires_grad_(true);
    (tiny->encode(image) * io.tensor("G").to(torch::kFloat64)).sum().backward();
    margins.near_relative("grad_image in double", image.grad(), io.tensor("grad_image"), GradientTolerance);
}

void check_tiny(Margins& margins, const TinyAutoencoder& tiny, const SafetensorsFile& io) {
    auto image = io.tensor("image").requires_grad_(true);
    const auto encoded = tiny->encode(image);
    margins.near_relative("encoded", encoded, io.tensor("encoded"), OutputTolerance);
    margins.near_relative("scaled_latents_01", (encoded / 6 + 0.5).clamp(0, 1),
                          io.tensor("scaled_latents_01"), OutputTolerance);
    (encoded * io.tensor("G")).sum().backward();
    check_kinked_gradient(image.grad(), io.tensor("grad_image"));
    const auto decoded = tiny->decode(io.tensor("encoded"));
    margins.near_relative("decoded", decoded, io.tensor("decoded"), OutputTolerance);
    margins.near_relative("decoded_clamped", decoded.clamp(0, 1), io.tensor("decoded_clamped"),
                          OutputTolerance);
    // In double: whether a ReLU passes a value that is nearly zero is up to the rounding of a processor's
    // kernels in single precision.
    TinyAutoencoder exact = tiny;
    exact->to(torch::kFloat64);
    auto latents = io.tensor("encoded").to(torch::kFloat64).requires_grad_(true);
    (exact->decode(latents) * io.tensor("H")).sum().backward();
    margins.near_relative("grad_latent", latents.grad(), io.tensor("grad_latent"), GradientTolerance);
    exact->to(torch::kFloat32);
    margins.near_relative("z_out", tiny->decode(io.tensor("z_in")), io.tensor("z_out"), OutputTolerance);
}

/// Writes the weights under the names of diffusers, as key_map.tsv says.
void write_diffusers_names(const GoldenCase& golden, const std::filesystem::path& folder) {
    NamedTensors tensors;
    std::ifstream table(golden.folder / "key_map.tsv");
    std::string line, half, original, shape, renamed;
    std::getline(table, line);
    while (table >> half >> original) {
        std::getline(table, line);
        renamed = line.substr(line.rfind('\t') + 1);
        tensors.emplace_back(renamed, golden.tensors("taesd_" + half + ".safetensors").tensor(original));
    }
    write_safetensors(folder / "diffusion_pytorch_model.safetensors", tensors);
    write_file(folder / "config.json", read_file(golden.folder / "diffusers_config.json"));
}

}  // namespace

DOCTEST_TEST_CASE("lcm: the UNet with an embedded guidance scale") {
    const GoldenCase golden("lcm");
    if (!golden.present) return;
    Margins margins("lcm unet");
    const auto unet = load_unet(golden);
    const auto io = golden.tensors();
    const auto scales = golden.json("case.json").at("guidance_scales_unet").get<std::vector<double>>();
    DOCTEST_REQUIRE(scales.size() == 2);
    for (std::size_t i = 0; i < scales.size(); ++i)
        check_embedded_scale(margins, unet, io, scales[i], std::to_string(i));
    const torch::NoGradGuard no_grad;
    const auto sample = io.tensor("sample"), context = io.tensor("encoder_hidden_states");
    margins.near("out.no_w", unet->forward(sample, io.tensor("t"), context), io.tensor("out.no_w"),
                 OutputTolerance);
    const auto rows = torch::stack({io.tensor("w_embedding.w0")[0], io.tensor("w_embedding.w1")[1]});
    margins.near("out.mixed_w", unet->forward(sample, torch::tensor({999, 19}), context, nullptr, rows),
                 io.tensor("out.mixed_w"),
                 OutputTolerance);  // timesteps as the case's README says
    for (const char* name : {"w_table.embedding", "w_table.embedding_odd"}) {
        const auto expected = io.tensor(name);
        margins.near(name, guidance_embedding(io.tensor("w_table.w"), expected.size(1)), expected,
                     EmbeddingTableTolerance);
    }
}

DOCTEST_TEST_CASE("lcm: image to image") {
    const GoldenCase golden("lcm");
    const BundleFolder folder("lcm", "lcm", "scheduler_config.json");
    if (!golden.present || !folder.present) return;
    Margins margins("lcm pipeline");
    const auto bundle = folder.load();
    DOCTEST_CHECK(bundle.kind == BundleKind::Lcm);
    const auto runs = golden.json("case.json").at("pipeline");
    for (const auto& [name, stated] : runs.items())
        check_lcm_run(margins, bundle, golden.tensors("pipeline_io.safetensors"), name, stated);
}

DOCTEST_TEST_CASE("ip2p: the UNet with eight channels") {
    const GoldenCase golden("ip2p");
    if (!golden.present) return;
    Margins margins("ip2p unet");
    const auto unet = load_unet(golden);
    DOCTEST_CHECK(takes_picture(unet->config()));
    const auto io = golden.tensors();
    auto sample = io.tensor("sample").requires_grad_(true),
         context = io.tensor("encoder_hidden_states").requires_grad_(true);
    const auto output = unet->forward(sample, io.tensor("t"), context);
    margins.near("out", output, io.tensor("out"), OutputTolerance);
    (output * io.tensor("G")).sum().backward();
    margins.near_relative("grad_sample", sample.grad(), io.tensor("grad_sample"), GradientTolerance);
    margins.near_relative("grad_encoder_hidden_states", context.grad(),
                          io.tensor("grad_encoder_hidden_states"), GradientTolerance);
    check_gradients(margins, *unet, io);
    const torch::NoGradGuard no_grad;
    margins.near("out_odd_t7",
                 unet->forward(io.tensor("sample_odd"), torch::tensor(7), context.narrow(0, 0, 1)),
                 io.tensor("out_odd_t7"), OutputTolerance);
}

DOCTEST_TEST_CASE("ip2p: editing a picture by an instruction") {
    const GoldenCase golden("ip2p");
    const BundleFolder folder("ip2p", "ip2p", "ddim_scheduler_config.json");
    if (!golden.present || !folder.present) return;
    Margins margins("ip2p pipeline");
    const auto runs = golden.json("case.json");
    for (const auto& [name, stated] : runs.items())
        check_instruction_run(margins, folder, golden, name, stated);
}

DOCTEST_TEST_CASE("taesd: both halves under both names, and gradients") {
    const GoldenCase golden("taesd");
    if (!golden.present) return;
    Margins margins("taesd");
    const auto io = golden.tensors();
    check_tiny(margins, load_tiny_autoencoder(golden.folder), io);
    check_exact_gradient(margins, load_tiny_autoencoder(golden.folder), io);
    const ScratchFolder scratch;
    write_diffusers_names(golden, scratch.path());
    check_tiny(margins, load_tiny_autoencoder(scratch.path()), io);
}

DOCTEST_TEST_CASE("taesd_img2img: with DDIM, and with LCM and guidance") {
    const GoldenCase golden("taesd_img2img"), tiny("taesd"), lcm("lcm");
    const BundleFolder folder("unet_sd1", "schedulers", "ddim_scheduler_config.json");
    if (!golden.present || !tiny.present || !lcm.present || !folder.present) return;
    Margins margins("taesd_img2img");
    const torch::NoGradGuard no_grad;
    const auto bundle = folder.load(tiny.folder.string());
    DOCTEST_REQUIRE(bundle.has_tiny());
    const auto io = golden.tensors();
    const auto clean = image_to_latents(bundle, io.tensor("init_image"), Codec::Quick);
    margins.near("init_latents", clean, io.tensor("init_latents"),
                 OutputTolerance * std::max(1.0, largest(io.tensor("init_latents"))));
    const auto stated_runs = golden.json("case.json");
    for (const auto& [name, stated] : stated_runs.items()) {
        const bool by_lcm = name == "lcm";
        const auto schedule =
            by_lcm ? NoiseSchedule(SchedulerConfig::from_json(lcm.json("scheduler_config.json"), lcm.folder))
                   : bundle.schedule;
        SamplerOptions options{.strength = stated.at("strength").get<double>()};
        if (by_lcm) options.original_steps = stated.at("original_inference_steps").get<std::int64_t>();
        const auto walk = image_to_image(by_lcm ? SamplerKind::Lcm : SamplerKind::Ddim, schedule,
                                         stated.at("steps").get<std::int64_t>(), options);
        const auto latents = io.tensor(name + ".latents_steps"), timesteps = io.tensor(name + ".timesteps");
        DOCTEST_REQUIRE(walk.sampler->step_count() - walk.first == timesteps.numel());
        const double tolerance = EditedLatents * largest(latents);
        const auto start = walk.sampler->start_from(clean, io.tensor("noise"), walk.first);
        margins.near(name + " start", start, latents[0], tolerance);
        DenoiseJob job;
        job.sampler = walk.sampler.get();
        job.first = walk.first;
        job.guidance_scale = stated.at("guidance_scale").get<double>();
        job.context = torch::cat({io.tensor("negative_prompt_embeds"), io.tensor("prompt_embeds")});
        job.noise = [&](std::int64_t step) {
            return io.tensor("step_noises")[std::min(step, io.tensor("step_noises").size(0) - 1)];
        };
        job.after_step = [&, &name = name](std::int64_t step, const torch::Tensor& x) {
            margins.near(name + " timestep", torch::tensor(walk.sampler->timestep(step)),
                         timesteps[step - walk.first].to(torch::kFloat64), 0);
            margins.near(name + " latents", x, latents[step - walk.first + 1], tolerance);
        };
        const auto result = denoise(bundle, start, job);
        margins.near(name + ".decoded", bundle.tiny->decode(result) * 2 - 1, io.tensor(name + ".decoded"),
                     EditedImage);
        margins.near(name + ".image", latents_to_image(bundle, result, Codec::Quick),
                     io.tensor(name + ".image"), EditedImage);
    }
}
