// The samplers: each is the published update rule in the conventions (timesteps, sigmas, last step) of
// diffusers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/neural/diffusion/schedulers.h"

namespace gse::neural {
namespace {

std::string spacing_of(const SchedulerConfig& config, const char* otherwise) {
    return config.timestep_spacing.empty() ? otherwise : config.timestep_spacing;
}

// `count` timesteps in ascending order; only linspace has fractions, unless `rounded`.
std::vector<double> ascending(const SchedulerConfig& config, const std::string& spacing, std::int64_t count,
                              bool rounded) {
    const auto total = config.num_train_timesteps;
    std::vector<double> result;
    for (std::int64_t i = 0; i < count; ++i) {
        double t = 0;
        if (spacing == "linspace") {
            t = count == 1 ? 0
                           : static_cast<double>(total - 1) * static_cast<double>(i) /
                                 static_cast<double>(count - 1);
            if (rounded) t = std::nearbyint(t);
        } else if (spacing == "leading") {
            t = static_cast<double>(i * (total / count) + config.steps_offset);
        } else {
            // The reference steps down by the difference of its first two values, which decides ties.
            const double all = static_cast<double>(total);
            const double stride = (all - all / static_cast<double>(count)) - all;
            t = std::nearbyint(all + static_cast<double>(count - 1 - i) * stride) - 1;
        }
        result.push_back(std::clamp(t, 0.0, static_cast<double>(total - 1)));
    }
    return result;
}

std::vector<double> reversed(std::vector<double> values) {
    std::reverse(values.begin(), values.end());
    return values;
}

torch::Tensor as_index(double t) { return torch::full({1}, static_cast<std::int64_t>(t), torch::kInt64); }

// Noise level sqrt((1-a)/a) at a fractional timestep, linear between the trained ones.
float sigma_at(const NoiseSchedule& schedule, double t) {
    const auto level = [&](std::int64_t i) {
        double a = schedule.alpha_cumprod(std::min(i, schedule.steps() - 1));
        if (a <= 0) a = LeastAlphaProduct;
        return std::sqrt((1.0 - a) / a);
    };
    const auto low = static_cast<std::int64_t>(t);
    const double part = t - static_cast<double>(low);
    return static_cast<float>(level(low) * (1 - part) + level(low + 1) * part);
}

class DdimSampler : public Sampler {
public:
    DdimSampler(const NoiseSchedule& schedule, std::int64_t steps, double eta)
        : Sampler(schedule), stride_(schedule.steps() / steps), eta_(eta) {
        timesteps_ =
            reversed(ascending(schedule.config(), spacing_of(schedule.config(), "leading"), steps, true));
    }
    bool needs_noise() const override { return eta_ > 0; }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& noise) override {
        const double t = timestep(i);
        const double a = alpha(static_cast<std::int64_t>(t));
        const double previous = alpha(static_cast<std::int64_t>(t) - stride_);
        predicted_x0_ = schedule_.to_x0(output, x, as_index(t));
        predicted_x0_ = clipped(predicted_x0_);
        const auto epsilon = schedule_.to_epsilon(output, x, as_index(t));
        const double variance = (1 - previous) / (1 - a) * (1 - a / previous);
        const double deviation = eta_ * std::sqrt(std::max(0.0, variance));
        auto next = std::sqrt(previous) * predicted_x0_ +
                    std::sqrt(std::max(0.0, 1 - previous - deviation * deviation)) * epsilon;
        return eta_ > 0 ? next + deviation * noise : next;
    }

protected:
    /// a_t; before the first timestep 1 or, as Stable Diffusion has it (set_alpha_to_one false), a_0.
    double alpha(std::int64_t t) const {
        if (t >= 0) return schedule_.alpha_cumprod(t);
        return schedule_.config().set_alpha_to_one ? 1.0 : schedule_.alpha_cumprod(0);
    }
    std::int64_t stride_;

private:
    double eta_;
};

/// DDIM run backwards: from a clean sample towards noise (Song et al. 2021, eq. 13 reversed).
class DdimInverseSampler final : public DdimSampler {
public:
    DdimInverseSampler(const NoiseSchedule& schedule, std::int64_t steps) : DdimSampler(schedule, steps, 0) {
        std::reverse(timesteps_.begin(), timesteps_.end());
    }
    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& /*noise*/) override {
        const auto target = static_cast<std::int64_t>(timestep(i));
        const double here = alpha(std::min(target - stride_, schedule_.steps() - 1));
        const double next = alpha(target);
        const double signal = std::sqrt(here), sigma = std::sqrt(1 - here);
        const bool velocity = schedule_.prediction() == Prediction::Velocity;
        predicted_x0_ = velocity ? signal * x - sigma * output : (x - sigma * output) / signal;
        const auto epsilon = velocity ? signal * output + sigma * x : output;
        return std::sqrt(next) * predicted_x0_ + std::sqrt(1 - next) * epsilon;
    }
};

/// Ancestral sampling of the original DDPM (Ho et al. 2020, eq. 7) with the small variance.
class DdpmSampler final : public Sampler {
public:
    DdpmSampler(const NoiseSchedule& schedule, std::int64_t steps)
        : Sampler(schedule), stride_(schedule.steps() / steps) {
        timesteps_ =
            reversed(ascending(schedule.config(), spacing_of(schedule.config(), "leading"), steps, true));
    }
    bool needs_noise() const override { return true; }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& noise) override {
        const auto t = static_cast<std::int64_t>(timestep(i));
        const double a = schedule_.alpha_cumprod(t);
        const double previous = t >= stride_ ? schedule_.alpha_cumprod(t - stride_) : 1.0;
        const double alpha = a / previous;
        predicted_x0_ = schedule_.to_x0(output, x, as_index(timestep(i)));
        predicted_x0_ = clipped(predicted_x0_);
        auto next = std::sqrt(previous) * (1 - alpha) / (1 - a) * predicted_x0_ +
                    std::sqrt(alpha) * (1 - previous) / (1 - a) * x;
        if (t == 0) return next;
        return next + std::sqrt(std::max((1 - previous) / (1 - a) * (1 - alpha), 1e-20)) * noise;
    }

private:
    std::int64_t stride_;
};

/// Euler steps of the probability-flow equation in sigma (Karras et al. 2022); ancestral with fresh noise.
class EulerSampler final : public Sampler {
public:
    EulerSampler(const NoiseSchedule& schedule, std::int64_t steps, bool ancestral)
        : Sampler(schedule), ancestral_(ancestral) {
        const auto spacing = spacing_of(schedule.config(), "linspace");
        timesteps_ = reversed(ascending(schedule.config(), spacing, steps, false));
        for (auto& t : timesteps_) {
            t = static_cast<float>(t);  // the reference keeps them in fp32
            sigmas_.push_back(sigma_at(schedule, t));
        }
        const double largest = sigmas_.front();
        initial_ = spacing == "leading" ? std::sqrt(largest * largest + 1) : largest;
        sigmas_.push_back(0);
    }
    double initial_sigma() const override { return initial_; }
    bool needs_noise() const override { return ancestral_; }
    torch::Tensor scale_input(const torch::Tensor& x, std::int64_t i) const override {
        const double sigma = sigmas_[static_cast<std::size_t>(i)];
        return x / std::sqrt(sigma * sigma + 1);
    }
    torch::Tensor start_from(const torch::Tensor& x0, const torch::Tensor& noise,
                             std::int64_t i) const override {
        return x0 + static_cast<double>(sigmas_[static_cast<std::size_t>(i)]) * noise;
    }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& noise) override {
        const double sigma = sigmas_[static_cast<std::size_t>(i)],
                     next = sigmas_[static_cast<std::size_t>(i) + 1];
        const double square = sigma * sigma + 1;
        predicted_x0_ = schedule_.prediction() == Prediction::Velocity
                            ? output * (-sigma / std::sqrt(square)) + x / square
                            : x - sigma * output;
        const auto slope = (x - predicted_x0_) / sigma;
        if (!ancestral_) return x + slope * (next - sigma);
        const double up = std::sqrt(next * next * (sigma * sigma - next * next) / (sigma * sigma));
        const double down = std::sqrt(next * next - up * up);
        return x + slope * (down - sigma) + up * noise;
    }

private:
    bool ancestral_;
    double initial_ = 1;
};

/// Pseudo linear multistep (Liu et al. 2022) without the Runge-Kutta warm-up: the second timestep is done
/// twice.
class PndmSampler final : public Sampler {
public:
    PndmSampler(const NoiseSchedule& schedule, std::int64_t steps)
        : Sampler(schedule), stride_(schedule.steps() / steps) {
        timesteps_ =
            reversed(ascending(schedule.config(), spacing_of(schedule.config(), "leading"), steps, true));
        if (steps > 1) timesteps_.insert(timesteps_.begin() + 1, timesteps_[1]);
    }

    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& /*noise*/) override {
        auto t = static_cast<std::int64_t>(timestep(i));
        auto previous = t - stride_;
        auto sample = x;
        auto combined = output;
        if (calls_ == 1) {  // the repeated step averages both slopes and starts again from the first sample
            previous = t;
            t = std::min(t + stride_, schedule_.steps() - 1);
            combined = (output + history_.back()) / 2;
            sample = first_;
        } else {
            history_.push_back(output);
            if (history_.size() > 4) history_.pop_front();
            if (calls_ == 0) first_ = x;
            combined = extrapolate();
        }
        ++calls_;
        return move(sample, combined, t, previous);
    }

private:
    // Adams-Bashforth coefficients for one to four known slopes, newest first.
    torch::Tensor extrapolate() const {
        const auto e = [&](std::size_t back) { return history_[history_.size() - back]; };
        switch (history_.size()) {
            case 1: return e(1);
            case 2: return (3 * e(1) - e(2)) / 2;
            case 3: return (23 * e(1) - 16 * e(2) + 5 * e(3)) / 12;
            default: return (55 * e(1) - 59 * e(2) + 37 * e(3) - 9 * e(4)) / 24;
        }
    }
    double alpha(std::int64_t t) const {
        if (t < 0) return schedule_.config().set_alpha_to_one ? 1.0 : schedule_.alpha_cumprod(0);
        const double product = schedule_.alpha_cumprod(t);
        return product > 0 ? product : LeastAlphaProduct;
    }
    torch::Tensor move(const torch::Tensor& x, const torch::Tensor& output, std::int64_t t,
                       std::int64_t previous) {
        const double a = alpha(t), to = alpha(previous);
        const auto epsilon = schedule_.prediction() == Prediction::Velocity
                                 ? std::sqrt(a) * output + std::sqrt(1 - a) * x
                                 : output;
        predicted_x0_ = (x - std::sqrt(1 - a) * epsilon) / std::sqrt(a);
        const double divisor = a * std::sqrt(1 - to) + std::sqrt(a * (1 - a) * to);
        return std::sqrt(to / a) * x - (to - a) / divisor * epsilon;
    }

    std::int64_t stride_;
    std::int64_t calls_ = 0;
    std::deque<torch::Tensor> history_;
    torch::Tensor first_;
};

/// DPM-Solver++ of second order, multistep, midpoint form (Lu et al. 2022, algorithm 2).
class DpmSolverSampler final : public Sampler {
public:
    DpmSolverSampler(const NoiseSchedule& schedule, std::int64_t steps) : Sampler(schedule) {
        const auto spacing = spacing_of(schedule.config(), "linspace");
        // One timestep more than steps, the lowest of which is not visited (not for "trailing").
        const bool drop = spacing != "trailing";
        timesteps_ = reversed(ascending(schedule.config(), spacing, steps + (drop ? 1 : 0), true));
        if (drop) timesteps_.pop_back();
        for (const auto t : timesteps_) sigmas_.push_back(sigma_at(schedule, t));
        sigmas_.push_back(0);
    }
    torch::Tensor step(const torch::Tensor& output, const torch::Tensor& x, std::int64_t i,
                       const torch::Tensor& /*noise*/) override {
        const Level from = level(i), to = level(i + 1);
        auto x0 = schedule_.prediction() == Prediction::Velocity ? from.signal * x - from.sigma * output
                                                                 : (x - from.sigma * output) / from.signal;
        const double h = to.lambda - from.lambda;
        const double gain = to.signal * std::expm1(-h);
        auto next = to.sigma / from.sigma * x - gain * x0;
        const bool last = i + 1 == step_count();
        if (previous_x0_.defined() && !last) {
            const double ratio = (from.lambda - level(i - 1).lambda) / h;
            next = next - 0.5 * gain / ratio * (x0 - previous_x0_);
        }
        previous_x0_ = x0;
        predicted_x0_ = x0;
        return next;
    }

private:
    struct Level {
        double signal = 1, sigma = 0, lambda = 0;
    };
    Level level(std::int64_t i) const {
        const double sigma = sigmas_[static_cast<std::size_t>(i)];
        const double signal = 1 / std::sqrt(sigma * sigma + 1);
        return {signal, sigma * signal,
                sigma > 0 ? -std::log(sigma) : std::numeric_limits<double>::infinity()};
    }
    torch::Tensor previous_x0_;
};

}  // namespace

torch::Tensor Sampler::clipped(const torch::Tensor& x0) const {
    const auto& config = schedule_.config();
    return config.clip_sample ? x0.clamp(-config.clip_sample_range, config.clip_sample_range) : x0;
}

torch::Tensor Sampler::start_from(const torch::Tensor& x0, const torch::Tensor& noise, std::int64_t i) const {
    return schedule_.add_noise(x0, noise, as_index(timestep(i)));
}

std::unique_ptr<Sampler> make_sampler(SamplerKind kind, const NoiseSchedule& schedule, std::int64_t steps,
                                      const SamplerOptions& options) {
    if (steps < 1 || steps > schedule.steps())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("{} sampling steps are outside 1..{}", steps, schedule.steps()));
    using enum SamplerKind;
    const bool any_prediction = kind == Ddim || kind == Ddpm || kind == Lcm || kind == Tcd;
    if (schedule.prediction() == Prediction::Sample && !any_prediction)
        throw Error(ErrorCode::Unsupported,
                    "a model that predicts the clean sample cannot be walked by this scheduler",
                    "use DDIMScheduler");
    switch (kind) {
        case SamplerKind::Ddim: return std::make_unique<DdimSampler>(schedule, steps, options.eta);
        case SamplerKind::DdimInverse: return std::make_unique<DdimInverseSampler>(schedule, steps);
        case SamplerKind::Ddpm: return std::make_unique<DdpmSampler>(schedule, steps);
        case SamplerKind::Euler: return std::make_unique<EulerSampler>(schedule, steps, false);
        case SamplerKind::EulerAncestral: return std::make_unique<EulerSampler>(schedule, steps, true);
        case SamplerKind::Pndm: return std::make_unique<PndmSampler>(schedule, steps);
        case SamplerKind::DpmSolverPp2M: return std::make_unique<DpmSolverSampler>(schedule, steps);
        case SamplerKind::Lcm:
        case SamplerKind::Tcd: return make_consistency_sampler(kind, schedule, steps, options);
    }
    GSE_CHECK(false);
}

}  // namespace gse::neural
