// Samplers of models distilled to few steps: latent consistency models (Luo et al. 2023, algorithm 3) and
// trajectory consistency distillation (Zheng et al. 2024, algorithm 4). Tables and the last step follow
// diffusers.
#include <fmt/format.h>

#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/neural/diffusion/schedulers.h"

namespace gse::neural {
namespace {

constexpr double BoundarySigma = 0.5;  // sigma_data of the boundary condition

torch::Tensor index_of(double t) { return torch::full({1}, static_cast<std::int64_t>(t), torch::kInt64); }

/// Levels that may be visited, ascending: those of the solver that the model was distilled from, up to the
/// strength.
std::vector<std::int64_t> visited_levels(const NoiseSchedule& schedule, const SamplerOptions& options) {
    const std::int64_t original =
        options.original_steps > 0 ? options.original_steps : schedule.config().original_inference_steps;
    if (original > schedule.steps())
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("{} original steps are more than the schedule's {}", original, schedule.steps()));
    if (!(options.strength > 0 && options.strength <= 1))
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("a strength of {} is outside 0..1", options.strength));
    std::vector<std::int64_t> levels;
    if (options.any_level) {
        const auto count =
            static_cast<std::int64_t>(static_cast<double>(schedule.steps()) * options.strength);
        for (std::int64_t t = 0; t < count; ++t) levels.push_back(t);
        return levels;
    }
    const auto stride = schedule.steps() / original;
    const auto count = static_cast<std::int64_t>(static_cast<double>(original) * options.strength);
    for (std::int64_t j = 1; j <= count; ++j) levels.push_back(j * stride - 1);
    return levels;
}

/// `steps` of them, evenly chosen from the highest down.
std::vector<double> consistency_timesteps(const NoiseSchedule& schedule, std::int64_t steps,
                                          const SamplerOptions& options) {
    const auto levels = visited_levels(schedule, options);
    const auto count = static_cast<std::int64_t>(levels.size());
    if (count < steps)
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("{} steps are more than the {} that the distilled model has at strength {:.2f}",
                        steps, count, options.strength),
            "use fewer steps or a higher strength");
    const double stride = static_cast<double>(count) / static_cast<double>(steps);
    std::vector<double> timesteps;
    for (std::int64_t i = 0; i < steps; ++i) {
        const auto place = static_cast<std::int64_t>(std::floor(static_cast<double>(i) * stride));
        timesteps.push_back(static_cast<double>(levels[static_cast<std::size_t>(count - 1 - place)]));
    }
    return timesteps;
}

class LcmSampler final : public Sampler {
public:
    LcmSampler(const NoiseSchedule& schedule, std::int64_t steps, const SamplerOptions& options)
        : Sampler(schedule) {
        timesteps_ = consistency_timesteps(schedule, steps, options);
    }
    bool needs_noise() const override { return true; }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& noise) override {
        const auto t = index_of(timestep(i));
        const auto boundary = boundary_scalings(timestep(i), schedule_.config().timestep_scaling);
        predicted_x0_ = boundary.out * clipped(schedule_.to_x0(output, x, t)) + boundary.skip * x;
        if (i + 1 == step_count()) return predicted_x0_;
        return schedule_.add_noise(predicted_x0_, noise, index_of(timestep(i + 1)));
    }
};

class TcdSampler final : public Sampler {
public:
    TcdSampler(const NoiseSchedule& schedule, std::int64_t steps, const SamplerOptions& options)
        : Sampler(schedule), eta_(options.eta) {
        timesteps_ = consistency_timesteps(schedule, steps, options);
    }
    bool needs_noise() const override { return eta_ > 0; }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& noise) override {
        const auto t = index_of(timestep(i));
        const bool last = i + 1 == step_count();
        const double previous = last ? 0 : timestep(i + 1);
        // The reference multiplies in fp32.
        const auto middle = std::floor(static_cast<float>(1 - eta_) * static_cast<float>(previous));
        predicted_x0_ = clipped(schedule_.to_x0(output, x, t));
        const auto reached =
            schedule_.add_noise(predicted_x0_, schedule_.to_epsilon(output, x, t), index_of(middle));
        if (last || eta_ <= 0) return reached;
        const double share = schedule_.alpha_cumprod(static_cast<std::int64_t>(previous)) /
                             static_cast<double>(schedule_.alpha_cumprod(static_cast<std::int64_t>(middle)));
        return std::sqrt(share) * reached + std::sqrt(1 - share) * noise;
    }

private:
    double eta_;
};

}  // namespace

BoundaryScalings boundary_scalings(double timestep, double timestep_scaling) {
    const double s = timestep * timestep_scaling;
    const double sum = s * s + BoundarySigma * BoundarySigma;
    return {BoundarySigma * BoundarySigma / sum, s / std::sqrt(sum)};
}

std::unique_ptr<Sampler> make_consistency_sampler(SamplerKind kind, const NoiseSchedule& schedule,
                                                  std::int64_t steps, const SamplerOptions& options) {
    if (kind == SamplerKind::Lcm) return std::make_unique<LcmSampler>(schedule, steps, options);
    GSE_CHECK(kind == SamplerKind::Tcd);
    return std::make_unique<TcdSampler>(schedule, steps, options);
}

}  // namespace gse::neural
