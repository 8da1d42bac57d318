// Adam in float, written so that the compiler can vectorise it (this file is built without errno for sqrt).
#include "engine/edit/optimise/adam.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr double Beta1 = 0.9, Beta2 = 0.999;
constexpr float AdamEpsilon = 1e-15f;
constexpr std::size_t LongestRow = 48;  // SH degree 3

/// The part of one step that does not depend on the value.
struct Step {
    float keep1 = 0, keep2 = 0, take1 = 0, take2 = 0;
    float correction1 = 0, correction2 = 0;  // 1 / (1 - beta^t)
};

Step make_step(int step) {
    const double power1 = std::pow(Beta1, step), power2 = std::pow(Beta2, step);
    return {static_cast<float>(Beta1),
            static_cast<float>(Beta2),
            static_cast<float>(1 - Beta1),
            static_cast<float>(1 - Beta2),
            static_cast<float>(1 / (1 - power1)),
            static_cast<float>(1 / (1 - power2))};
}

/// `count` values that share one learning rate.
void update(float* parameter, const float* gradient, float* first, float* second, std::size_t count,
            float rate, const Step& step) {
    for (std::size_t i = 0; i < count; ++i) {
        const float g = gradient[i];
        const float m = step.keep1 * first[i] + step.take1 * g;
        const float v = step.keep2 * second[i] + step.take2 * (g * g);
        first[i] = m;
        second[i] = v;
        parameter[i] -= rate * (m * step.correction1) / (std::sqrt(v * step.correction2) + AdamEpsilon);
    }
}

/// One row whose components have rates of their own.
void update_row(float* parameter, const float* gradient, float* first, float* second, std::size_t count,
                const float* rates, const Step& step) {
    for (std::size_t i = 0; i < count; ++i) {
        const float g = gradient[i];
        const float m = step.keep1 * first[i] + step.take1 * g;
        const float v = step.keep2 * second[i] + step.take2 * (g * g);
        first[i] = m;
        second[i] = v;
        parameter[i] -= rates[i] * (m * step.correction1) / (std::sqrt(v * step.correction2) + AdamEpsilon);
    }
}

}  // namespace

void adam_step(std::span<float> parameters, std::span<const float> gradient, AdamMoments& moments,
               const AdamRates& rates) {
    const std::size_t stride = rates.rates.size();
    GSE_CHECK_EQ(parameters.size(), gradient.size());
    GSE_CHECK(stride > 0 && stride <= LongestRow && parameters.size() % stride == 0);
    moments.first.resize(parameters.size());
    moments.second.resize(parameters.size());
    const Step step = make_step(rates.step);
    const bool one_rate =
        std::all_of(rates.rates.begin(), rates.rates.end(), [&](double r) { return r == rates.rates[0]; });
    float* first = moments.first.data();
    float* second = moments.second.data();
    if (one_rate && rates.row_factor.empty()) {
        update(parameters.data(), gradient.data(), first, second, parameters.size(),
               static_cast<float>(rates.rates[0]), step);
        return;
    }
    std::array<float, LongestRow> row_rates{};
    for (std::size_t row = 0; row < parameters.size() / stride; ++row) {
        const double factor = rates.row_factor.empty() ? 1 : rates.row_factor[row];
        for (std::size_t i = 0; i < stride; ++i) row_rates[i] = static_cast<float>(rates.rates[i] * factor);
        const std::size_t at = row * stride;
        update_row(parameters.data() + at, gradient.data() + at, first + at, second + at, stride,
                   row_rates.data(), step);
    }
}

}  // namespace gse::edit
