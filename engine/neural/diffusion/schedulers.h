// Noise schedules of diffusion models and the samplers that walk them (DDIM, DDPM, Euler, PNDM, DPM++ 2M,
// LCM, TCD).
#pragma once

#include <torch/torch.h>

#include <memory>
#include <vector>

#include "engine/neural/api/config.h"

namespace gse::neural {

/// Meaning of the UNet's output.
enum class Prediction { Epsilon, Velocity, Sample };

/// The forward process: betas and cumulative products, fp32 as in the reference.
class NoiseSchedule {
public:
    explicit NoiseSchedule(const SchedulerConfig& config);

    const torch::Tensor& betas() const { return betas_; }                    // [T] fp32, CPU
    const torch::Tensor& alphas_cumprod() const { return alphas_cumprod_; }  // [T] fp32, CPU
    float alpha_cumprod(std::int64_t t) const { return values_[static_cast<std::size_t>(t)]; }
    std::int64_t steps() const { return static_cast<std::int64_t>(values_.size()); }
    Prediction prediction() const { return prediction_; }
    const SchedulerConfig& config() const { return config_; }

    /// sqrt(a_t) x0 + sqrt(1-a_t) noise; t [B] or scalar int64.
    torch::Tensor add_noise(const torch::Tensor& x0, const torch::Tensor& noise,
                            const torch::Tensor& t) const;
    /// Target of velocity prediction: sqrt(a_t) noise - sqrt(1-a_t) x0.
    torch::Tensor velocity(const torch::Tensor& x0, const torch::Tensor& noise, const torch::Tensor& t) const;
    /// Training target of the UNet, according to the configured prediction.
    torch::Tensor target(const torch::Tensor& x0, const torch::Tensor& noise, const torch::Tensor& t) const;
    /// The noise, or the clean sample, that a model output stands for at x_t.
    torch::Tensor to_epsilon(const torch::Tensor& output, const torch::Tensor& x_t,
                             const torch::Tensor& t) const;
    torch::Tensor to_x0(const torch::Tensor& output, const torch::Tensor& x_t, const torch::Tensor& t) const;
    /// a_t / (1-a_t), [B].
    torch::Tensor snr(const torch::Tensor& t) const;

private:
    // sqrt(a_t) and sqrt(1-a_t), shaped to multiply `like`.
    std::pair<torch::Tensor, torch::Tensor> roots(const torch::Tensor& t, const torch::Tensor& like) const;

    SchedulerConfig config_;
    torch::Tensor betas_, alphas_cumprod_;
    std::vector<float> values_;
    Prediction prediction_;
};

/// Stand-in for an alphas_cumprod of 0 where it is divided by (diffusers: "close to 0 without being 0").
constexpr double LeastAlphaProduct = 0x1p-24;

/// alphas_cumprod [steps] of the scaled_linear schedule, fp32 on the CPU.
torch::Tensor scaled_linear_alphas_cumprod(std::int64_t steps, double beta_start, double beta_end);

enum class SamplerKind { Ddim, DdimInverse, Ddpm, Euler, EulerAncestral, Pndm, DpmSolverPp2M, Lcm, Tcd };

/// One walk from noise to a sample (DdimInverse: back). Usage, for step i in [first, step_count()):
///   output = unet(scale_input(x, i), timestep(i)); x = step(output, x, i, noise).
class Sampler {
public:
    virtual ~Sampler() = default;
    virtual torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                               const torch::Tensor& noise) = 0;
    virtual torch::Tensor scale_input(const torch::Tensor& x, std::int64_t /*i*/) const { return x; }
    /// x at step i for a clean sample: where img2img begins.
    virtual torch::Tensor start_from(const torch::Tensor& x0, const torch::Tensor& noise,
                                     std::int64_t i) const;
    virtual double initial_sigma() const { return 1.0; }  // factor of unit noise at the first step
    virtual bool needs_noise() const { return false; }    // step() wants fresh unit noise

    std::int64_t step_count() const { return static_cast<std::int64_t>(timesteps_.size()); }
    double timestep(std::int64_t i) const { return timesteps_[static_cast<std::size_t>(i)]; }
    const std::vector<double>& timesteps() const { return timesteps_; }
    const std::vector<float>& sigmas() const { return sigmas_; }  // Euler and DPM++ only; the last is the end
    /// Clean sample estimated by the latest step.
    const torch::Tensor& predicted_x0() const { return predicted_x0_; }

protected:
    explicit Sampler(const NoiseSchedule& schedule) : schedule_(schedule) {}
    /// Clips a clean sample to its range where the schedule's configuration asks for it.
    torch::Tensor clipped(const torch::Tensor& x0) const;

    const NoiseSchedule schedule_;
    std::vector<double> timesteps_;
    std::vector<float> sigmas_;
    torch::Tensor predicted_x0_;
};

/// Options of some samplers; the others ignore them.
struct SamplerOptions {
    double eta = 0;  // share of fresh noise: DDIM's eta, TCD's gamma
    // LCM, TCD: image to image begins at this share of their table; see image_to_image()
    double strength = 1;
    // LCM, TCD: of the solver they were distilled from; 0 = as the configuration says.
    std::int64_t original_steps = 0;
    bool any_level = false;  // TCD: visits every timestep, not only the solver's
};

/// Throws Error (InvalidArgument) for a number of steps that the schedule, or the table of a distilled model,
/// does not have.
std::unique_ptr<Sampler> make_sampler(SamplerKind kind, const NoiseSchedule& schedule, std::int64_t steps,
                                      const SamplerOptions& options = {});

/// LCM and TCD: the samplers of models distilled to few steps.
std::unique_ptr<Sampler> make_consistency_sampler(SamplerKind kind, const NoiseSchedule& schedule,
                                                  std::int64_t steps, const SamplerOptions& options);

/// Shares of the sample and of what the network says in a consistency model's answer: at timestep 0 the
/// sample itself.
struct BoundaryScalings {
    double skip = 0, out = 1;
};
BoundaryScalings boundary_scalings(double timestep, double timestep_scaling);

/// An image to image run: what walks, and the first step that is done.
struct ImageToImage {
    std::unique_ptr<Sampler> sampler;
    std::int64_t first = 0;
};
/// Prepares an image to image run. LCM and TCD take the strength into their table and do all `steps`. The
/// others do the last int(steps * strength) steps, at least one.
ImageToImage image_to_image(SamplerKind kind, const NoiseSchedule& schedule, std::int64_t steps,
                            SamplerOptions options);

/// The sampler a scheduler_config.json names. Throws Error (Model) for one that is not implemented.
SamplerKind sampler_kind(const SchedulerConfig& config);

/// First step of img2img: the last int(steps * strength) steps are done.
std::int64_t first_step(std::int64_t step_count, double strength);

}  // namespace gse::neural
