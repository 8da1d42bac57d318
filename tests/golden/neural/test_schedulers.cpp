// Noise schedule and samplers against diffusers.
#include "engine/neural/diffusion/schedulers.h"

#include "tests/golden/neural/fake_model.h"
#include "tests/golden/neural/golden_case.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the case's README.
constexpr double ConversionTolerance = 1e-5;
constexpr double SigmaRelative = 1e-5;

struct Walk {
    std::string name;
    SamplerKind kind;
    bool velocity = false;
    double eta = 0;
    bool from_image = false;  // steps and strength as case.json states them under the walk's name
};

const char* config_file(SamplerKind kind) {
    return kind == SamplerKind::Pndm ? "pndm_scheduler_config.json" : "ddim_scheduler_config.json";
}

SchedulerConfig config_for(const GoldenCase& golden, const Walk& walk) {
    const auto path = golden.folder / config_file(walk.kind);
    auto config = SchedulerConfig::from_json(read_json_file(path), path);
    if (walk.velocity) config.prediction_type = "v_prediction";
    if (walk.kind == SamplerKind::Ddpm) config.steps_offset = 0;  // the case: "DDPM has none"
    return config;
}

torch::Tensor start_of(const Walk& walk, const Sampler& sampler, const SafetensorsFile& io,
                       std::int64_t first) {
    if (walk.kind == SamplerKind::DdimInverse) return io.tensor("x0");
    if (walk.from_image) return sampler.start_from(io.tensor("x0"), io.tensor("noise"), first);
    return io.tensor("xT") * sampler.initial_sigma();
}

void check_walk(Margins& margins, const GoldenCase& golden, const Walk& walk) {
    const auto io = golden.tensors();
    const auto stated = golden.json("case.json");
    const FakeModel fake_model(stated.at("fake_model"));
    const auto expected = io.tensor(walk.name + ".latents");
    const auto noises = io.tensor("step_noises");
    const NoiseSchedule schedule(config_for(golden, walk));
    const std::int64_t steps = walk.from_image
                                   ? stated.at(walk.name).at("steps").get<std::int64_t>()
                                   : expected.size(0) - 1 - (walk.kind == SamplerKind::Pndm ? 1 : 0);
    const auto sampler = make_sampler(walk.kind, schedule, steps, {.eta = walk.eta});
    const auto first =
        walk.from_image ? first_step(sampler->step_count(), stated.at(walk.name).at("strength").get<double>())
                        : 0;
    DOCTEST_REQUIRE(sampler->step_count() - first == expected.size(0) - 1);
    if (io.contains(walk.name + ".init_noise_sigma"))
        margins.near_relative(walk.name + ".init_noise_sigma", torch::tensor(sampler->initial_sigma()),
                              io.tensor(walk.name + ".init_noise_sigma"), SigmaRelative);
    auto x = start_of(walk, *sampler, io, first);
    near_scaled(margins, walk.name + " start", x, expected[0], TrajectoryRelative, TrajectoryAbsolute);
    for (std::int64_t i = first; i < sampler->step_count(); ++i) {
        if (io.contains(walk.name + ".timesteps"))
            margins.near(walk.name + ".timesteps", torch::tensor(sampler->timestep(i)),
                         io.tensor(walk.name + ".timesteps")[i - first].to(torch::kFloat64), 0);
        const auto output = fake_model(sampler->scale_input(x, i), sampler->timestep(i));
        x = sampler->step(output, x, i, noises[std::min(i - first, noises.size(0) - 1)]);
        near_scaled(margins, walk.name + " step " + std::to_string(i), x, expected[i - first + 1],
                    TrajectoryRelative, TrajectoryAbsolute);
        if (io.contains(walk.name + ".pred_x0"))
            near_scaled(margins, walk.name + " x0", sampler->predicted_x0(),
                        io.tensor(walk.name + ".pred_x0")[i - first], TrajectoryRelative, TrajectoryAbsolute);
    }
}

/// "ddim.timesteps_20_linspace", "euler.sigmas_50", ...
void check_spacings(Margins& margins, const GoldenCase& golden, const std::string& prefix, const Walk& walk) {
    const auto io = golden.tensors();
    std::size_t compared = 0;
    for (const auto& [name, entry] : io.entries()) {
        const std::string timesteps = prefix + ".timesteps_", sigmas = prefix + ".sigmas_";
        const bool sigma = name.starts_with(sigmas);
        if (!sigma && !name.starts_with(timesteps)) continue;
        const auto rest = name.substr((sigma ? sigmas : timesteps).size());
        auto config = config_for(golden, walk);
        if (const auto bar = rest.find('_'); bar != std::string::npos)
            config.timestep_spacing = rest.substr(bar + 1);
        const auto sampler = make_sampler(walk.kind, NoiseSchedule(config), std::stoll(rest));
        if (sigma)
            near_scaled(margins, name, torch::tensor(sampler->sigmas()), io.tensor(name), SigmaRelative,
                        1e-30);
        else margins.near(name, torch::tensor(sampler->timesteps()), io.tensor(name), 0);
        ++compared;
    }
    DOCTEST_CHECK(compared > 0);
}

}  // namespace

DOCTEST_TEST_CASE("schedulers: betas, products, noise and conversions") {
    const GoldenCase golden("schedulers");
    if (!golden.present) return;
    Margins margins("schedulers");
    const auto io = golden.tensors();
    const NoiseSchedule schedule(config_for(golden, {"", SamplerKind::Ddim}));
    const NoiseSchedule velocity(config_for(golden, {"", SamplerKind::Ddim, true}));
    margins.near("betas", schedule.betas(), io.tensor("betas"), CumprodTolerance);
    margins.near("alphas_cumprod", schedule.alphas_cumprod(), io.tensor("alphas_cumprod"), CumprodTolerance);
    const float last = schedule.config().set_alpha_to_one ? 1.0f : schedule.alpha_cumprod(0);
    margins.near("final_alpha_cumprod", torch::tensor(last), io.tensor("final_alpha_cumprod"),
                 CumprodTolerance);
    const auto t = io.tensor("add_noise.t"), x0 = io.tensor("add_noise.x0"),
               noise = io.tensor("add_noise.noise");
    const auto x_t = io.tensor("add_noise.out"), v = io.tensor("v.in");
    margins.near("add_noise", schedule.add_noise(x0, noise, t), x_t, ConversionTolerance);
    margins.near("velocity", schedule.velocity(x0, noise, t), io.tensor("velocity.out"), ConversionTolerance);
    margins.near("v.x0", velocity.to_x0(v, x_t, t), io.tensor("v.x0"), ConversionTolerance);
    margins.near("v.eps", velocity.to_epsilon(v, x_t, t), io.tensor("v.eps"), ConversionTolerance);
    near_scaled(margins, "eps.x0", schedule.to_x0(v, x_t, t), io.tensor("eps.x0"), 1e-5, ConversionTolerance);
    near_scaled(margins, "snr", schedule.snr(t), io.tensor("snr.t"), 1e-4, ConversionTolerance);
}

DOCTEST_TEST_CASE("schedulers: trajectories of all samplers") {
    const GoldenCase golden("schedulers");
    if (!golden.present) return;
    Margins margins("sampler trajectories");
    using enum SamplerKind;
    const std::vector<Walk> walks = {{"ddim_txt2img", Ddim},
                                     {"ddim_txt2img_v", Ddim, true},
                                     {"ddim_img2img", Ddim, false, 0, true},
                                     {"ddim_eta1", Ddim, false, 1.0},
                                     {"ddim_inverse", DdimInverse},
                                     {"ddpm", Ddpm},
                                     {"euler", Euler},
                                     {"euler_v", Euler, true},
                                     {"euler_a", EulerAncestral},
                                     {"pndm", Pndm},
                                     {"dpmpp_2m", DpmSolverPp2M}};
    for (const auto& walk : walks) {
        DOCTEST_SUBCASE(walk.name.c_str()) { check_walk(margins, golden, walk); }
    }
}

DOCTEST_TEST_CASE("schedulers: timesteps and sigmas of all spacings") {
    const GoldenCase golden("schedulers");
    if (!golden.present) return;
    Margins margins("timesteps and sigmas");
    check_spacings(margins, golden, "ddim", {"", SamplerKind::Ddim});
    check_spacings(margins, golden, "ddpm", {"", SamplerKind::Ddpm});
    check_spacings(margins, golden, "euler", {"", SamplerKind::Euler});
    check_spacings(margins, golden, "pndm", {"", SamplerKind::Pndm});
    check_spacings(margins, golden, "dpmpp_2m", {"", SamplerKind::DpmSolverPp2M});
}
