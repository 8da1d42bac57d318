// Functions of the direction as spherical harmonics: sampled, changed and projected back.
#pragma once

#include <array>
#include <cstddef>

#include "engine/math/spherical_harmonics.h"
#include "engine/math/vec.h"

namespace gse {

/// Directions of a quadrature (Gauss-Legendre nodes in z, even steps around it). It is exact for polynomials
/// up to degree 7. Products of two basis functions have degree 6 at most.
inline constexpr std::size_t ShDirections = 32;

/// Basis of one degree at the directions, and their weights.
class ShSampling {
public:
    /// `degree` is 0 to MaxShDegree.
    explicit ShSampling(int degree);

    std::size_t coefficients() const { return coefficients_; }
    const Vec3& direction(std::size_t index) const { return directions_[index]; }
    /// Value of the function with these coefficients (every `stride`-th number) in a direction.
    double value(std::size_t direction, const float* coefficients, std::size_t stride) const;
    /// One coefficient of the function with these values in the directions.
    double coefficient(const std::array<double, ShDirections>& values, std::size_t index) const;
    /// Coefficients of the function with these values in the directions.
    void project(const std::array<double, ShDirections>& values, float* coefficients,
                 std::size_t stride) const;

private:
    std::size_t coefficients_;
    std::array<Vec3, ShDirections> directions_;
    std::array<double, ShDirections> weights_{};
    std::array<std::array<double, MaxShCoefficients>, ShDirections> basis_{};
};

/// Coefficients of turned functions as a matrix [to][from]: f(R^T d) for every f of the basis. R may be a
/// mirror image, too.
using ShRotation = std::array<std::array<double, MaxShCoefficients>, MaxShCoefficients>;
ShRotation sh_rotation(const Mat3& rotation, int degree);

}  // namespace gse
