// Shared parts of the cases of samplers: the function that stands in for a network, and the comparison of
// trajectories.
#pragma once

#include "tests/golden/neural/golden_case.h"

namespace gse::test {

// Of the cases' README files.
constexpr double TrajectoryRelative = 1e-4, TrajectoryAbsolute = 1e-4;

/// Stand-in for a network: linear * x + sine * sin(frequency * x + t / period).
struct FakeModel {
    explicit FakeModel(const neural::Json& stated)
        : linear(stated.at("linear").get<double>()), sine(stated.at("sine").get<double>()),
          frequency(stated.at("frequency").get<double>()), period(stated.at("period").get<double>()) {}
    torch::Tensor operator()(const torch::Tensor& x, double t) const {
        return linear * x + sine * torch::sin(frequency * x + t / period);
    }
    double linear, sine, frequency, period;
};

inline void near_scaled(Margins& margins, const std::string& what, const torch::Tensor& actual,
                        const torch::Tensor& expected, double relative, double absolute) {
    DOCTEST_REQUIRE_MESSAGE(actual.sizes() == expected.sizes(), what);
    const auto allowed = expected.abs() * relative + absolute;
    margins.near(what, (actual - expected) / allowed, torch::zeros_like(expected), 1.0);
}

}  // namespace gse::test
