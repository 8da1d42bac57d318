// Whole models against diffusers: text to image, image to image, score distillation, single-file checkpoints.
#include "engine/base/error.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the cases' README files.
constexpr double LatentTolerance = 1e-4;  // of the largest value
constexpr double ImageTolerance = 1e-3;

/// The pipeline's folder with its links in place, also where a checkout keeps links as small text files.
void restore_links(const std::filesystem::path& from, const std::filesystem::path& to) {
    for (const auto& item : std::filesystem::directory_iterator(from)) {
        const auto target = to / item.path().filename();
        if (item.is_directory()) {
            std::filesystem::create_directory_symlink(std::filesystem::canonical(item.path()), target);
        } else if (item.path().extension().empty() && item.file_size() < 256) {
            auto link = read_file(item.path());
            while (!link.empty() && std::isspace(static_cast<unsigned char>(link.back()))) link.pop_back();
            std::filesystem::create_directory_symlink(std::filesystem::canonical(from / link), target);
        } else {
            std::filesystem::create_symlink(std::filesystem::canonical(item.path()), target);
        }
    }
}

struct Pipeline {
    Pipeline() : golden("pipeline_sd1") {
        if (golden.present) restore_links(golden.folder, scratch.path());
    }
    ModelBundle load() const { return load_bundle(scratch.path()); }
    GoldenCase golden;
    ScratchFolder scratch;
};

torch::Tensor context_of(const SafetensorsFile& io) {
    return torch::cat({io.tensor("negative_prompt_embeds"), io.tensor("prompt_embeds")});
}

/// "mean.t421.s7.5." for that guidance scale, however the case writes the number.
std::string scale_prefix(const SafetensorsFile& io, const std::string& at, double scale) {
    constexpr std::string_view last = ".grad_latents";
    for (const auto& [name, entry] : io.entries()) {
        if (!name.starts_with(at + "s") || !name.ends_with(last)) continue;
        const auto text = name.substr(at.size() + 1, name.size() - at.size() - 1 - last.size());
        if (std::stod(text) == scale) return at + "s" + text + ".";
    }
    DOCTEST_FAIL("no tensors of guidance scale ", scale, " under ", at);
    return {};
}

void check_sds_step(Margins& margins, const ModelBundle& bundle, const SafetensorsFile& io,
                    const std::string& mode, std::int64_t t, const std::vector<double>& scales) {
    auto image = io.tensor("image").requires_grad_(true);
    const auto moments = bundle.vae->encode_moments(image);
    const auto z = mode == "mean" ? moments.mean : moments.sample(io.tensor("posterior_eps"));
    const auto latents = z * bundle.scaling_factor();
    margins.near(mode + ".latents", latents, io.tensor(mode + ".latents"), OutputTolerance);
    const std::string at = mode + ".t" + std::to_string(t) + ".";
    for (const double scale : scales) {
        const auto scaled = scale_prefix(io, at, scale);
        const auto result = sds_gradient(
            bundle, latents,
            {io.tensor("noise"), t, scale, torch::cat({io.tensor("uncond"), io.tensor("cond")})});
        margins.near(at + "noisy", result.noisy_latents, io.tensor(at + "noisy_latents"), OutputTolerance);
        margins.near(at + "eps_uncond", result.epsilon_negative, io.tensor(at + "eps_uncond"),
                     OutputTolerance);
        margins.near(at + "eps_cond", result.epsilon_positive, io.tensor(at + "eps_cond"), OutputTolerance);
        margins.near(at + "w", torch::tensor(result.weight), io.tensor(at + "w"), OutputTolerance);
        margins.near_relative(scaled + "grad_latents", result.gradient, io.tensor(scaled + "grad_latents"),
                              GradientTolerance);
        if (!io.contains(scaled + "grad_image")) continue;
        const auto gradient = torch::autograd::grad({latents}, {image}, {result.gradient}, true)[0];
        margins.near_relative(scaled + "grad_image", gradient, io.tensor(scaled + "grad_image"),
                              GradientTolerance);
    }
}

/// Every output of a component case, with weights from a single file.
void check_single_file(const std::string& name, const std::string& version, SingleFileText expected_layout) {
    const GoldenCase golden(name), unet_case("unet_" + version), vae_case("vae"),
        text_case("clip_text_" + version);
    if (!golden.present || !unet_case.present || !vae_case.present || !text_case.present) return;
    Margins margins(name);
    const auto file = golden.tensors("model_fp16.safetensors");
    DOCTEST_CHECK(is_single_file(file));
    const auto layout = single_file_text_layout(file);
    DOCTEST_CHECK(layout == expected_layout);
    const UNet unet(UNetConfig::from_json(golden.json("unet_config.json"), golden.folder));
    const AutoencoderKl vae(VaeConfig::from_json(golden.json("vae_config.json"), golden.folder));
    const ClipTextEncoder text(
        TextEncoderConfig::from_json(golden.json("text_encoder_config.json"), golden.folder));
    std::set<std::string> used;
    const auto load = [&](torch::nn::Module& module, const LoadPlan& plan) {
        const auto keys = load_weights(module, file, plan);
        used.insert(keys.begin(), keys.end());
    };
    load(*unet.ptr(), single_file_unet_plan(unet->config()));
    load(*vae.ptr(), single_file_vae_plan(vae->config()));
    load(*text.ptr(), single_file_text_plan(text->config(), layout));
    std::ifstream table(golden.folder / "key_map.tsv");
    std::string line;
    std::getline(table, line);  // the header
    for (std::size_t rows = 0; std::getline(table, line); ++rows) {
        const auto key = line.substr(0, line.find('\t'));
        // position_ids is a tensor of the text encoder that no one needs.
        const bool ignored =
            line.ends_with("ignore") || line.ends_with("ignore\r") || key.ends_with(".position_ids");
        DOCTEST_CHECK_MESSAGE(used.contains(key) != ignored, key);
    }
    const torch::NoGradGuard no_grad;
    const auto u = unet_case.tensors(), v = vae_case.tensors(), c = text_case.tensors();
    margins.near("unet", unet->forward(u.tensor("sample"), u.tensor("t1"), u.tensor("encoder_hidden_states")),
                 u.tensor("out_t1"), OutputTolerance);
    margins.near("mean", vae->encode_moments(v.tensor("image")).mean, v.tensor("mean"), OutputTolerance);
    margins.near("decoded", vae->decode(v.tensor("z")), v.tensor("decoded"), OutputTolerance);
    const auto encoding = text->forward(c.tensor("input_ids"));
    margins.near("text", encoding.last_hidden, c.tensor("last_hidden_state"), OutputTolerance);
    if (text->config().with_projection)
        margins.near("text_embeds", encoding.text_embeds, c.tensor("text_embeds"), OutputTolerance);
}

}  // namespace

DOCTEST_TEST_CASE("pipeline_sd1: text to image with guidance") {
    const Pipeline pipeline;
    if (!pipeline.golden.present) return;
    Margins margins("pipeline_sd1 txt2img");
    const auto io = pipeline.golden.tensors();
    const auto what = pipeline.golden.json("case.json");
    const auto bundle = pipeline.load();
    const auto prompt = what.at("prompt").get<std::string>(),
               negative = what.at("negative_prompt").get<std::string>();
    DOCTEST_CHECK(torch::equal(bundle.token_ids({prompt, negative}), io.tensor("input_ids")));
    const auto context = bundle.encode_prompts({negative, prompt});
    margins.near("context", context, context_of(io), OutputTolerance);
    const auto sampler = make_sampler(sampler_kind(bundle.schedule.config()), bundle.schedule,
                                      what.at("steps").get<std::int64_t>());
    DenoiseJob job;
    job.sampler = sampler.get();
    job.guidance_scale = what.at("guidance_scale").get<double>();
    job.context = context;
    const auto expected = io.tensor("latents_steps");
    job.after_step = [&](std::int64_t step, const torch::Tensor& latents) {
        margins.near("latents", latents, expected[step], LatentTolerance * largest(expected));
    };
    const auto latents = denoise(bundle, io.tensor("latents_init") * sampler->initial_sigma(), job);
    const torch::NoGradGuard no_grad;
    margins.near("decoded_raw", bundle.vae->decode(latents / bundle.scaling_factor()),
                 io.tensor("decoded_raw"), ImageTolerance);
    margins.near("image", latents_to_image(bundle, latents), io.tensor("image"), ImageTolerance);
}

DOCTEST_TEST_CASE("pipeline_sd1: image to image with guidance") {
    const Pipeline pipeline;
    if (!pipeline.golden.present) return;
    Margins margins("pipeline_sd1 img2img");
    const auto io = pipeline.golden.tensors();
    const auto what = pipeline.golden.json("case.json");
    const auto bundle = pipeline.load();
    const auto sampler = make_sampler(sampler_kind(bundle.schedule.config()), bundle.schedule,
                                      what.at("img2img").at("steps").get<std::int64_t>());
    DenoiseJob job;
    job.sampler = sampler.get();
    job.first = first_step(sampler->step_count(), what.at("img2img").at("strength").get<double>());
    job.guidance_scale = what.at("guidance_scale").get<double>();
    job.context = context_of(io);
    const torch::NoGradGuard no_grad;
    const auto expected = io.tensor("img2img.latents_steps");
    const auto start = sampler->start_from(image_to_latents(bundle, io.tensor("img2img.init_image")),
                                           io.tensor("img2img.noise"), job.first);
    margins.near("start", start, expected[0], LatentTolerance * largest(expected));
    job.after_step = [&](std::int64_t step, const torch::Tensor& latents) {
        margins.near("timestep", torch::tensor(sampler->timestep(step)),
                     io.tensor("img2img.timesteps")[step - job.first], 0);
        margins.near("latents", latents, expected[step - job.first + 1], LatentTolerance * largest(expected));
    };
    const auto latents = denoise(bundle, start, job);
    margins.near("image", latents_to_image(bundle, latents), io.tensor("img2img.image"), ImageTolerance);
}

DOCTEST_TEST_CASE("sds: gradient on latents and image, mean and sampled posterior") {
    const Pipeline pipeline;
    const GoldenCase golden("sds");
    if (!pipeline.golden.present || !golden.present) return;
    Margins margins("sds");
    const auto bundle = pipeline.load();
    const auto io = golden.tensors();
    margins.near("alphas_cumprod", bundle.schedule.alphas_cumprod(), io.tensor("alphas_cumprod"), 2e-6);
    const auto stated = golden.json("case.json");
    const auto timesteps = stated.at("timesteps").get<std::vector<std::int64_t>>();
    const auto scales = stated.at("guidance_scales").get<std::vector<double>>();
    for (const char* mode : {"mean", "sample"})
        for (const auto t : timesteps) check_sds_step(margins, bundle, io, mode, t, scales);
    std::size_t gradients = 0;  // none of the file's is left unread
    for (const auto& [name, entry] : io.entries())
        if (!name.starts_with("render.") && name.ends_with(".grad_latents")) ++gradients;
    DOCTEST_CHECK(gradients == 2 * timesteps.size() * scales.size());
}

DOCTEST_TEST_CASE("sds: through the bilinear resize of a render") {
    const Pipeline pipeline;
    const GoldenCase golden("sds");
    if (!pipeline.golden.present || !golden.present) return;
    Margins margins("sds render");
    const auto bundle = pipeline.load();
    const auto io = golden.tensors();
    const auto stated = golden.json("case.json").at("render");
    auto render = io.tensor("render").requires_grad_(true);
    DOCTEST_CHECK(render.size(3) == stated.at("side").get<std::int64_t>());
    const auto size = stated.at("resized").get<std::int64_t>();
    const auto resized = torch::upsample_bilinear2d(render, {size, size}, false);
    margins.near("resized", resized, io.tensor("render.resized"), OutputTolerance);
    const auto moments = bundle.vae->encode_moments(resized * 2 - 1);
    const auto latents = moments.sample(io.tensor("posterior_eps")) * bundle.scaling_factor();
    margins.near("latents", latents, io.tensor("render.latents"), OutputTolerance);
    const auto result = sds_gradient(
        bundle, latents,
        {io.tensor("noise"), stated.at("timestep").get<std::int64_t>(),
         stated.at("guidance_scale").get<double>(), torch::cat({io.tensor("uncond"), io.tensor("cond")})});
    margins.near_relative("grad_latents", result.gradient, io.tensor("render.grad_latents"),
                          GradientTolerance);
    latents.backward(result.gradient);
    margins.near_relative("grad_render", render.grad(), io.tensor("render.grad_render"), GradientTolerance);
}

DOCTEST_TEST_CASE("single_file_sd1: ldm names") {
    check_single_file("single_file_sd1", "sd1", SingleFileText::Transformers);
}

DOCTEST_TEST_CASE("single_file_sd2: ldm and OpenCLIP names") {
    check_single_file("single_file_sd2", "sd2", SingleFileText::OpenClip);
}

DOCTEST_TEST_CASE("single_file_sd1: opened as a model, with the tokenizer beside it") {
    const Pipeline pipeline;
    const GoldenCase golden("single_file_sd1");
    if (!pipeline.golden.present || !golden.present) return;
    const ScratchFolder scratch;
    for (const auto& item : std::filesystem::directory_iterator(golden.folder))
        std::filesystem::create_symlink(std::filesystem::canonical(item.path()),
                                        scratch.path() / item.path().filename());
    std::filesystem::create_directory_symlink(
        std::filesystem::canonical(pipeline.golden.folder / "tokenizer"), scratch.path() / "tokenizer");
    const auto path = scratch.path() / "model_fp16.safetensors";
    const auto bundle = load_bundle(path);
    const auto io = pipeline.golden.tensors();
    const auto what = pipeline.golden.json("case.json");
    const auto context = bundle.encode_prompts(
        {what.at("negative_prompt").get<std::string>(), what.at("prompt").get<std::string>()});
    DOCTEST_CHECK(difference(context, context_of(io)) <= OutputTolerance);
    const auto description = describe_model(path);
    DOCTEST_CHECK(description.layout == "single file");
    DOCTEST_CHECK(description.parameters == describe_model(pipeline.scratch.path()).parameters);
}
