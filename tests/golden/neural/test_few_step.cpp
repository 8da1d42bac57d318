// Samplers of models with few steps against diffusers: LCM, trailing Euler (Turbo), TCD.
#include <regex>
#include <set>

#include "engine/base/error.h"
#include "engine/neural/diffusion/schedulers.h"
#include "engine/neural/diffusion/unet.h"
#include "engine/neural/weights/key_map.h"
#include "tests/golden/neural/fake_model.h"
#include "tests/golden/neural/tolerances.h"

namespace {

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

// The tolerances of the cases' README files.
constexpr double ScalingRelative = 1e-5;
constexpr double TurboSigmaRelative = 5e-5;
constexpr double UNetWalkTolerance = 1e-4;  // of the largest value

SchedulerConfig config_in(const GoldenCase& golden, const std::string& file) {
    return SchedulerConfig::from_json(golden.json(file), golden.folder / file);
}

FakeModel stated_fake_model() {
    return FakeModel(GoldenCase("schedulers").json("case.json").at("fake_model"));
}

double number_or(const std::ssub_match& match, double otherwise) {
    return match.matched ? std::stod(match.str()) : otherwise;
}

struct Table {
    std::int64_t steps = 0;
    SamplerOptions options;
};

/// "timesteps.4.original_100.strength_0.29", "tcd.timesteps_4.arbitrary.strength_0.7"; false for another
/// name.
bool read_table_name(const std::string& name, Table& table) {
    static const std::regex pattern(
        R"((?:tcd\.)?timesteps[._](\d+)(\.arbitrary)?(?:\.original_(\d+))?(?:\.strength_([0-9.]+))?)");
    std::smatch found;
    if (!std::regex_match(name, found, pattern)) return false;
    table.steps = std::stoll(found[1]);
    table.options = {};
    table.options.any_level = found[2].matched;
    table.options.original_steps = static_cast<std::int64_t>(number_or(found[3], 0));
    table.options.strength = number_or(found[4], 1);
    return true;
}

/// All tables of the file; returns the strengths and the numbers of original steps that were among them.
std::set<double> check_tables(Margins& margins, const SafetensorsFile& io, SamplerKind kind,
                              const NoiseSchedule& schedule, std::set<std::int64_t>* originals = nullptr) {
    std::set<double> strengths;
    Table table;
    for (const auto& [name, entry] : io.entries()) {
        if (!read_table_name(name, table)) continue;
        const auto sampler = make_sampler(kind, schedule, table.steps, table.options);
        margins.near(name, torch::tensor(sampler->timesteps()), io.tensor(name).to(torch::kFloat64), 0);
        strengths.insert(table.options.strength);
        if (originals != nullptr) originals->insert(table.options.original_steps);
    }
    return strengths;
}

/// The sampler of a walk whose name does not say its strength: one of the known strengths has its timesteps.
std::unique_ptr<Sampler> sampler_with_timesteps(SamplerKind kind, const NoiseSchedule& schedule,
                                                const torch::Tensor& timesteps,
                                                const std::set<double>& strengths, SamplerOptions options) {
    for (const double strength : strengths) {
        options.strength = strength;
        auto sampler = make_sampler(kind, schedule, timesteps.numel(), options);
        if (difference(torch::tensor(sampler->timesteps()), timesteps) == 0) return sampler;
    }
    DOCTEST_FAIL("no known strength has the timesteps of the walk");
    return nullptr;
}

/// A walk of which all that a step gives was kept.
void check_steps(Margins& margins, const std::string& name, const SafetensorsFile& io, Sampler& sampler,
                 std::int64_t first, torch::Tensor x) {
    const auto fake_model = stated_fake_model();
    const auto latents = io.tensor(name + ".latents"), outputs = io.tensor(name + ".model_out"),
               timesteps = io.tensor(name + ".timesteps"), noises = io.tensor("step_noises");
    DOCTEST_REQUIRE(sampler.step_count() - first == latents.size(0) - 1);
    near_scaled(margins, name + " start", x, latents[0], TrajectoryRelative, TrajectoryAbsolute);
    for (std::int64_t i = first; i < sampler.step_count(); ++i) {
        const auto at = i - first;
        const auto where = name + " step " + std::to_string(at);
        margins.near(where, torch::tensor(sampler.timestep(i)), timesteps[at].to(torch::kFloat64), 0);
        const auto output = fake_model(sampler.scale_input(x, i), sampler.timestep(i));
        near_scaled(margins, where, output, outputs[at], TrajectoryRelative, TrajectoryAbsolute);
        x = sampler.step(output, x, i, noises[at]);
        near_scaled(margins, where, x, latents[at + 1], TrajectoryRelative, TrajectoryAbsolute);
        for (const char* kept : {".denoised", ".pred_x0"})
            if (io.contains(name + kept))
                near_scaled(margins, where + kept, sampler.predicted_x0(), io.tensor(name + kept)[at],
                            TrajectoryRelative, TrajectoryAbsolute);
    }
}

std::set<std::string> walks_of(const SafetensorsFile& io, const std::string& prefix) {
    constexpr std::string_view last = ".latents";
    std::set<std::string> names;
    for (const auto& [name, entry] : io.entries())
        if (name.starts_with(prefix) && name.ends_with(last))
            names.insert(name.substr(0, name.size() - last.size()));
    DOCTEST_CHECK(!names.empty());
    return names;
}

bool has_part(const std::string& name, const std::string& part) {
    return name.ends_with("_" + part) || name.find("_" + part + "_") != std::string::npos;
}

SchedulerConfig with_prediction(SchedulerConfig config, const std::string& type) {
    config.prediction_type = type;
    return config;
}

/// "step.<type>.i<k>.denoised": single steps of the table that is as long as the highest k says.
void check_single_steps(Margins& margins, const SafetensorsFile& io, const SchedulerConfig& stated) {
    static const std::regex pattern(R"(step\.(epsilon|sample|v_prediction)(_clip)?\.i(\d+)\.denoised)");
    std::smatch found;
    std::int64_t steps = 0;
    for (const auto& [name, entry] : io.entries())
        if (std::regex_match(name, found, pattern))
            steps = std::max<std::int64_t>(steps, std::stoll(found[3]) + 1);
    DOCTEST_REQUIRE(steps > 0);
    for (const auto& [name, entry] : io.entries()) {
        if (!std::regex_match(name, found, pattern)) continue;
        auto config = with_prediction(stated, found[1]);
        config.clip_sample = found[2].matched;
        const auto sampler = make_sampler(SamplerKind::Lcm, NoiseSchedule(config), steps);
        const auto after = sampler->step(io.tensor("step.model_output"), io.tensor("step.sample"),
                                         std::stoll(found[3]), io.tensor("step.noise"));
        const auto stem = name.substr(0, name.rfind('.'));
        near_scaled(margins, name, sampler->predicted_x0(), io.tensor(name), TrajectoryRelative,
                    TrajectoryAbsolute);
        near_scaled(margins, stem, after, io.tensor(stem + ".prev_sample"), TrajectoryRelative,
                    TrajectoryAbsolute);
    }
}

}  // namespace

DOCTEST_TEST_CASE("lcm: tables, scalings and single steps") {
    const GoldenCase golden("lcm");
    if (!golden.present) return;
    Margins margins("lcm tables");
    const auto io = golden.tensors("scheduler_io.safetensors");
    const auto config = config_in(golden, "scheduler_config.json");
    DOCTEST_CHECK(sampler_kind(config) == SamplerKind::Lcm);
    const NoiseSchedule schedule(config);
    margins.near("alphas_cumprod", schedule.alphas_cumprod(), io.tensor("alphas_cumprod"), CumprodTolerance);
    std::set<std::int64_t> originals;
    const auto strengths = check_tables(margins, io, SamplerKind::Lcm, schedule, &originals);
    const auto stated = golden.json("case.json");
    for (const double strength : stated.at("strengths").get<std::vector<double>>()) {
        DOCTEST_CHECK_MESSAGE(strengths.contains(strength), strength);
        const auto levels =
            static_cast<std::int64_t>(static_cast<double>(config.original_inference_steps) * strength);
        DOCTEST_CHECK(
            make_sampler(SamplerKind::Lcm, schedule, levels, {.strength = strength})->step_count() == levels);
        DOCTEST_CHECK_THROWS_AS(make_sampler(SamplerKind::Lcm, schedule, levels + 1, {.strength = strength}),
                                Error);
    }
    DOCTEST_CHECK(originals.contains(stated.at("original_inference_steps_2").get<std::int64_t>()));
    DOCTEST_CHECK_THROWS_AS(
        make_sampler(SamplerKind::Lcm, schedule, 1, {.original_steps = schedule.steps() + 1}), Error);
    const auto t = io.tensor("scalings.t");
    std::vector<double> skip, out;
    for (std::int64_t i = 0; i < t.numel(); ++i) {
        const auto scalings = boundary_scalings(t[i].item<double>(), config.timestep_scaling);
        skip.push_back(scalings.skip);
        out.push_back(scalings.out);
    }
    const auto doubles = [](const std::vector<double>& values) {
        return torch::tensor(values, torch::kFloat64);
    };
    near_scaled(margins, "c_skip", doubles(skip), io.tensor("scalings.c_skip").to(torch::kFloat64),
                ScalingRelative, 1e-30);
    near_scaled(margins, "c_out", doubles(out), io.tensor("scalings.c_out").to(torch::kFloat64),
                ScalingRelative, 1e-30);
    check_single_steps(margins, io, config);
}

DOCTEST_TEST_CASE("lcm: trajectories") {
    const GoldenCase golden("lcm");
    if (!golden.present) return;
    Margins margins("lcm trajectories");
    const auto io = golden.tensors("scheduler_io.safetensors");
    const auto config = config_in(golden, "scheduler_config.json");
    const auto listed = golden.json("case.json").at("strengths").get<std::set<double>>();
    for (const auto& name : walks_of(io, "traj_")) {
        const NoiseSchedule schedule(
            with_prediction(config, has_part(name, "v") ? "v_prediction" : config.prediction_type));
        const bool from_image = has_part(name, "img2img");
        const auto sampler =
            sampler_with_timesteps(SamplerKind::Lcm, schedule, io.tensor(name + ".timesteps"),
                                   from_image ? listed : std::set<double>{1.0}, {});
        check_steps(margins, name, io, *sampler, 0,
                    from_image ? sampler->start_from(io.tensor("x0"), io.tensor("add_noise.noise"), 0)
                               : io.tensor("xT") * sampler->initial_sigma());
    }
}

DOCTEST_TEST_CASE("turbo: tables of trailing spacing and of TCD") {
    const GoldenCase golden("turbo");
    if (!golden.present) return;
    Margins margins("turbo tables");
    const auto io = golden.tensors("scheduler_io.safetensors");
    const auto config = config_in(golden, "scheduler_config.json");
    DOCTEST_CHECK(sampler_kind(config) == SamplerKind::Euler);
    const NoiseSchedule schedule(config);
    margins.near("alphas_cumprod", schedule.alphas_cumprod(), io.tensor("alphas_cumprod"), CumprodTolerance);
    const std::string prefix = "euler.timesteps_";
    for (const auto& [name, entry] : io.entries()) {
        if (!name.starts_with(prefix)) continue;
        const auto steps = name.substr(prefix.size());
        for (const auto kind : {SamplerKind::Euler, SamplerKind::EulerAncestral}) {
            const auto sampler = make_sampler(kind, schedule, std::stoll(steps));
            margins.near(name, torch::tensor(sampler->timesteps()), io.tensor(name).to(torch::kFloat64), 0);
            near_scaled(margins, "sigmas " + steps, torch::tensor(sampler->sigmas()),
                        io.tensor("euler.sigmas_" + steps), TurboSigmaRelative, 1e-30);
            margins.near_relative("init sigma " + steps, torch::tensor(sampler->initial_sigma()),
                                  io.tensor("euler.init_noise_sigma_" + steps), TurboSigmaRelative);
        }
        // DDIM with this spacing visits the same levels: how such a model redraws views.
        const auto ddim = make_sampler(SamplerKind::Ddim, schedule, std::stoll(steps));
        margins.near(name, torch::tensor(ddim->timesteps()), io.tensor(name).to(torch::kFloat64), 0);
    }
    for (std::int64_t steps = 1; steps <= 128; ++steps)  // 61, 103, 121, 122: arange has an entry too many
        DOCTEST_CHECK(make_sampler(SamplerKind::Euler, schedule, steps)->step_count() == steps);
    const auto tcd = config_in(golden, "tcd_scheduler_config.json");
    DOCTEST_CHECK(sampler_kind(tcd) == SamplerKind::Tcd);
    DOCTEST_CHECK(check_tables(margins, io, SamplerKind::Tcd, NoiseSchedule(tcd)).size() > 1);
}

DOCTEST_TEST_CASE("turbo: trajectories of Euler, ancestral and TCD") {
    const GoldenCase golden("turbo");
    if (!golden.present) return;
    Margins margins("turbo trajectories");
    const auto io = golden.tensors("scheduler_io.safetensors");
    static const std::regex pattern(
        R"((euler|euler_a|tcd)(_img2img)?_(\d+)(_v)?(?:_s([0-9.]+))?(?:_eta([0-9.]+))?)");
    std::set<double> strengths;
    Table table;
    for (const auto& [name, entry] : io.entries())
        if (read_table_name(name, table)) strengths.insert(table.options.strength);
    for (const char* prefix : {"euler_", "tcd_"}) {
        for (const auto& name : walks_of(io, prefix)) {
            std::smatch found;
            DOCTEST_REQUIRE_MESSAGE(std::regex_match(name, found, pattern), name);
            const bool tcd = found[1] == "tcd", from_image = found[2].matched;
            const auto stated =
                config_in(golden, tcd ? "tcd_scheduler_config.json" : "scheduler_config.json");
            const NoiseSchedule schedule(
                with_prediction(stated, found[4].matched ? "v_prediction" : stated.prediction_type));
            SamplerOptions options{.eta = number_or(found[6], 0), .strength = number_or(found[5], 1)};
            ImageToImage walk;
            if (tcd) {
                walk.sampler =
                    sampler_with_timesteps(SamplerKind::Tcd, schedule, io.tensor(name + ".timesteps"),
                                           from_image ? strengths : std::set<double>{1.0}, options);
            } else {
                const auto kind = found[1] == "euler" ? SamplerKind::Euler : SamplerKind::EulerAncestral;
                walk = image_to_image(kind, schedule, std::stoll(found[3]), options);
            }
            auto& sampler = *walk.sampler;
            check_steps(margins, name, io, sampler, walk.first,
                        from_image
                            ? sampler.start_from(io.tensor("x0"), io.tensor("add_noise.noise"), walk.first)
                            : io.tensor("xT") * sampler.initial_sigma());
        }
    }
}

DOCTEST_TEST_CASE("turbo: walks with a UNet, without guidance") {
    const GoldenCase golden("turbo"), network("unet_sd1");
    if (!golden.present || !network.present) return;
    Margins margins("turbo unet");
    const torch::NoGradGuard no_grad;
    UNet unet(UNetConfig::from_json(network.json("config.json"), network.folder / "config.json"));
    load_weights(*unet, network.tensors("diffusion_pytorch_model.safetensors"), unet_plan());
    const NoiseSchedule schedule(config_in(golden, "scheduler_config.json"));
    const auto io = golden.tensors();
    static const std::regex pattern(R"(unet(_img2img)?_(\d+)(?:_s([0-9.]+))?)");
    for (const auto& name : walks_of(io, "unet_")) {
        std::smatch found;
        DOCTEST_REQUIRE_MESSAGE(std::regex_match(name, found, pattern), name);
        auto walk = image_to_image(SamplerKind::Euler, schedule, std::stoll(found[2]),
                                   {.strength = number_or(found[3], 1)});
        auto& sampler = *walk.sampler;
        const auto latents = io.tensor(name + ".latents"), timesteps = io.tensor(name + ".timesteps");
        DOCTEST_REQUIRE(sampler.step_count() - walk.first == timesteps.numel());
        const double tolerance = UNetWalkTolerance * largest(latents);
        auto x = found[1].matched ? sampler.start_from(io.tensor("x0"), io.tensor("xT"), walk.first)
                                  : io.tensor("xT") * sampler.initial_sigma();
        margins.near(name + " start", x, latents[0], tolerance);
        for (std::int64_t i = walk.first; i < sampler.step_count(); ++i) {
            const auto at = i - walk.first;
            margins.near(name + " timestep", torch::tensor(sampler.timestep(i)),
                         timesteps[at].to(torch::kFloat64), 0);
            const auto t = torch::full({1}, sampler.timestep(i), torch::kFloat32);
            x = sampler.step(unet->forward(sampler.scale_input(x, i), t, io.tensor("prompt_embeds")), x, i,
                             {});
            margins.near(name + " latents", x, latents[at + 1], tolerance);
        }
    }
}
