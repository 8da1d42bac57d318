// Gauss-Legendre times even steps: a product quadrature of the sphere.
#include "engine/math/sh_projection.h"

#include <cmath>
#include <numbers>

namespace gse {
namespace {

constexpr std::size_t Rings = 4, Steps = 8;
static_assert(Rings * Steps == ShDirections);
// Nodes and weights of the interval [-1, 1] (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, Rings> Node = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                            0.8611363115940526};
constexpr std::array<double, Rings> Weight = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                              0.3478548451374538};

}  // namespace

ShSampling::ShSampling(int degree) : coefficients_(static_cast<std::size_t>(sh_coefficient_count(degree))) {
    for (std::size_t i = 0; i < ShDirections; ++i) {
        const double z = Node[i / Steps], around = std::sqrt(1 - z * z);
        const double angle =
            2 * std::numbers::pi * static_cast<double>(i % Steps) / static_cast<double>(Steps);
        directions_[i] = {around * std::cos(angle), around * std::sin(angle), z};
        weights_[i] = Weight[i / Steps] * 2 * std::numbers::pi / static_cast<double>(Steps);
        sh_basis(directions_[i], degree, basis_[i].data());
    }
}

double ShSampling::value(std::size_t direction, const float* coefficients, std::size_t stride) const {
    double sum = 0;
    for (std::size_t k = 0; k < coefficients_; ++k)
        sum += basis_[direction][k] * static_cast<double>(coefficients[k * stride]);
    return sum;
}

double ShSampling::coefficient(const std::array<double, ShDirections>& values, std::size_t index) const {
    double sum = 0;
    for (std::size_t i = 0; i < ShDirections; ++i) sum += weights_[i] * basis_[i][index] * values[i];
    return sum;
}

void ShSampling::project(const std::array<double, ShDirections>& values, float* coefficients,
                         std::size_t stride) const {
    for (std::size_t k = 0; k < coefficients_; ++k)
        coefficients[k * stride] = static_cast<float>(coefficient(values, k));
}

ShRotation sh_rotation(const Mat3& rotation, int degree) {
    const ShSampling sampling(degree);
    ShRotation matrix{};
    for (std::size_t from = 0; from < sampling.coefficients(); ++from) {
        std::array<double, ShDirections> values{};
        for (std::size_t i = 0; i < ShDirections; ++i) {
            std::array<double, MaxShCoefficients> basis{};
            sh_basis(rotation.transposed() * sampling.direction(i), degree, basis.data());
            values[i] = basis[from];
        }
        for (std::size_t to = 0; to < sampling.coefficients(); ++to)
            matrix[to][from] = sampling.coefficient(values, to);
    }
    return matrix;
}

}  // namespace gse
