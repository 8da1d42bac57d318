// Tolerances that several golden tests share.
#pragma once

namespace gse::test {

// Absolute, of alphas_cumprod: the references multiply in single precision.
constexpr double CumprodTolerance = 2e-6;
constexpr double OutputTolerance = 2e-5;    // of the largest value, of a network's output
constexpr double GradientTolerance = 2e-4;  // of the tensor's largest value

}  // namespace gse::test
