// The forward process and the conversions between noise, velocity and clean sample.
#include "engine/neural/diffusion/schedulers.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

constexpr double MaxBeta = 0.999;  // of the cosine schedule

torch::Tensor make_betas(const SchedulerConfig& config) {
    const auto steps = config.num_train_timesteps;
    if (config.beta_schedule == "linear")
        return torch::linspace(config.beta_start, config.beta_end, steps, torch::kFloat32);
    if (config.beta_schedule == "scaled_linear")
        return torch::linspace(std::sqrt(config.beta_start), std::sqrt(config.beta_end), steps,
                               torch::kFloat32)
            .square();
    const auto bar = [](double t) {
        return std::pow(std::cos((t + 0.008) / 1.008 * std::acos(-1.0) / 2), 2);
    };
    std::vector<float> betas;
    for (std::int64_t i = 0; i < steps; ++i) {
        const double here = static_cast<double>(i) / static_cast<double>(steps);
        const double next = static_cast<double>(i + 1) / static_cast<double>(steps);
        betas.push_back(static_cast<float>(std::min(1.0 - bar(next) / bar(here), MaxBeta)));
    }
    return torch::tensor(betas);
}

/// Betas whose product of alphas ends at 0, in fp32 as the reference (Lin et al. 2024, algorithm 1).
torch::Tensor with_zero_terminal_snr(const torch::Tensor& betas) {
    auto roots = torch::cumprod(1.0 - betas, 0).sqrt();
    const auto first = roots[0].clone(), last = roots[-1].clone();
    roots = (roots - last) * (first / (first - last));
    const auto products = roots.square();
    const auto later = products.slice(0, 1) / products.slice(0, 0, -1);
    return 1.0 - torch::cat({products.slice(0, 0, 1), later});
}

torch::Tensor betas_of(const SchedulerConfig& config) {
    const auto betas = make_betas(config);
    return config.rescale_betas_zero_snr && config.num_train_timesteps > 1 ? with_zero_terminal_snr(betas)
                                                                           : betas;
}

/// Products of alphas. A prediction of noise cannot be turned into a picture at 0: there it ends just above.
torch::Tensor products_of(const torch::Tensor& betas, Prediction prediction) {
    auto products = torch::cumprod(1.0 - betas, 0);
    if (prediction == Prediction::Epsilon && products[-1].item<float>() <= 0)
        products[-1] = LeastAlphaProduct;
    return products;
}

Prediction prediction_of(const SchedulerConfig& config) {
    if (config.prediction_type == "v_prediction") return Prediction::Velocity;
    return config.prediction_type == "sample" ? Prediction::Sample : Prediction::Epsilon;
}

}  // namespace

NoiseSchedule::NoiseSchedule(const SchedulerConfig& config)
    : config_(config), betas_(betas_of(config)), alphas_cumprod_(products_of(betas_, prediction_of(config))),
      prediction_(prediction_of(config)) {
    const float* data = alphas_cumprod_.data_ptr<float>();
    values_.assign(data, data + alphas_cumprod_.numel());
}

std::pair<torch::Tensor, torch::Tensor> NoiseSchedule::roots(const torch::Tensor& t,
                                                             const torch::Tensor& like) const {
    auto a = alphas_cumprod_.index_select(0, t.to(torch::kCPU, torch::kInt64).reshape({-1}));
    std::vector<std::int64_t> shape(static_cast<std::size_t>(like.dim()), 1);
    shape[0] = a.size(0);
    a = a.view(shape);
    return {a.sqrt().to(like.device(), like.scalar_type()),
            (1.0 - a).sqrt().to(like.device(), like.scalar_type())};
}

torch::Tensor NoiseSchedule::add_noise(const torch::Tensor& x0, const torch::Tensor& noise,
                                       const torch::Tensor& t) const {
    const auto [signal, sigma] = roots(t, x0);
    return signal * x0 + sigma * noise;
}

torch::Tensor NoiseSchedule::velocity(const torch::Tensor& x0, const torch::Tensor& noise,
                                      const torch::Tensor& t) const {
    const auto [signal, sigma] = roots(t, x0);
    return signal * noise - sigma * x0;
}

torch::Tensor NoiseSchedule::target(const torch::Tensor& x0, const torch::Tensor& noise,
                                    const torch::Tensor& t) const {
    if (prediction_ == Prediction::Sample) return x0;
    return prediction_ == Prediction::Velocity ? velocity(x0, noise, t) : noise;
}

torch::Tensor NoiseSchedule::to_epsilon(const torch::Tensor& output, const torch::Tensor& x_t,
                                        const torch::Tensor& t) const {
    if (prediction_ == Prediction::Epsilon) return output;
    const auto [signal, sigma] = roots(t, x_t);
    if (prediction_ == Prediction::Sample) return (x_t - signal * output) / sigma;
    return signal * output + sigma * x_t;
}

torch::Tensor NoiseSchedule::to_x0(const torch::Tensor& output, const torch::Tensor& x_t,
                                   const torch::Tensor& t) const {
    if (prediction_ == Prediction::Sample) return output;
    const auto [signal, sigma] = roots(t, x_t);
    return prediction_ == Prediction::Velocity ? signal * x_t - sigma * output
                                               : (x_t - sigma * output) / signal;
}

torch::Tensor NoiseSchedule::snr(const torch::Tensor& t) const {
    const auto a = alphas_cumprod_.index_select(0, t.to(torch::kCPU, torch::kInt64).reshape({-1}));
    return a / (1.0 - a);
}

torch::Tensor scaled_linear_alphas_cumprod(std::int64_t steps, double beta_start, double beta_end) {
    SchedulerConfig config;
    config.num_train_timesteps = steps;
    config.beta_start = beta_start;
    config.beta_end = beta_end;
    return NoiseSchedule(config).alphas_cumprod();
}

SamplerKind sampler_kind(const SchedulerConfig& config) {
    const auto& name = config.class_name;
    if (name == "DDIMScheduler") return SamplerKind::Ddim;
    if (name == "DDPMScheduler") return SamplerKind::Ddpm;
    if (name == "EulerDiscreteScheduler") return SamplerKind::Euler;
    if (name == "EulerAncestralDiscreteScheduler") return SamplerKind::EulerAncestral;
    if (name == "PNDMScheduler") return SamplerKind::Pndm;
    if (name == "DPMSolverMultistepScheduler") return SamplerKind::DpmSolverPp2M;
    if (name == "LCMScheduler") return SamplerKind::Lcm;
    if (name == "TCDScheduler") return SamplerKind::Tcd;
    throw Error(ErrorCode::Model, fmt::format("the scheduler \"{}\" is not supported", name),
                "use DDIMScheduler");
}

std::int64_t first_step(std::int64_t step_count, double strength) {
    const auto kept =
        std::min(step_count, static_cast<std::int64_t>(static_cast<double>(step_count) * strength));
    return std::max<std::int64_t>(0, step_count - kept);
}

ImageToImage image_to_image(SamplerKind kind, const NoiseSchedule& schedule, std::int64_t steps,
                            SamplerOptions options) {
    if (kind == SamplerKind::Lcm || kind == SamplerKind::Tcd)
        return {make_sampler(kind, schedule, steps, options), 0};
    auto sampler = make_sampler(kind, schedule, steps, options);
    const auto count = sampler->step_count();
    return {std::move(sampler), std::min(first_step(count, options.strength), count - 1)};
}

}  // namespace gse::neural
