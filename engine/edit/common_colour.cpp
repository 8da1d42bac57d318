// Terms of the affine map, its gradient and its step.
#include "engine/edit/common_colour.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/math/sh.h"

namespace gse::edit {
namespace {

constexpr double ConstantShare = 0.5;   // of the constant term: low, so that black stays black
constexpr double FirstShare = 1.5;      // of the first axis, along which the colours change most
constexpr double DarkestLabel = 0.1;    // darker labels count as this bright
constexpr double LeastSpread = 0.03;    // of the first axis: what spreads less is noise, and is not blown up further

Vec3 base_colour(const float* sh) { return {colour_from_sh(sh[0]), colour_from_sh(sh[1]), colour_from_sh(sh[2])}; }

/// Second moments of the colours about black.
Mat3 second_moments(std::span<const float> birth, std::size_t stride) {
    Mat3 sum;
    const std::size_t rows = birth.size() / stride;
    for (std::size_t i = 0; i < rows; ++i) {
        const Vec3 colour = base_colour(&birth[i * stride]);
        for (int row = 0; row < 3; ++row)
            for (int column = row; column < 3; ++column)
                sum(row, column) += colour[row] * colour[column] / static_cast<double>(rows);
    }
    return sum;
}

}  // namespace

CommonColour::CommonColour(std::span<const float> birth, std::size_t stride) : stride_(stride) {
    GSE_CHECK_EQ(birth.size() % stride, std::size_t{0});
    const SymmetricEigen eigen = symmetric_eigen(second_moments(birth, stride));
    const double first = std::max(std::sqrt(std::max(eigen.value[0], 0.0)), DarkestLabel);
    for (std::size_t k = 0; k < 3; ++k) {
        const double spread = k == 0 ? first : std::max(std::sqrt(std::max(eigen.value[k], 0.0)), LeastSpread * first);
        axis_[k] = eigen.axis[k] * ((k == 0 ? FirstShare : 1.0) / spread);
    }
}

std::array<double, CommonColour::Terms> CommonColour::terms(const float* birth) const {
    const Vec3 colour = base_colour(birth);
    return {ConstantShare, dot(axis_[0], colour), dot(axis_[1], colour), dot(axis_[2], colour)};
}

void CommonColour::step(std::span<const float> gradient, std::span<const float> birth, std::span<float> sh, double rate) {
    GSE_CHECK_EQ(gradient.size(), sh.size());
    GSE_CHECK_EQ(birth.size(), sh.size());
    const std::size_t rows = sh.size() / stride_;
    if (rows == 0) return;
    std::array<double, 3 * Terms> sum{};
    for (std::size_t i = 0; i < rows; ++i) {
        const auto own = terms(&birth[i * stride_]);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < Terms; ++k) sum[c * Terms + k] += gradient[i * stride_ + c] * own[k];
    }
    Coefficients mean, change = learned_;
    for (std::size_t j = 0; j < sum.size(); ++j) mean[j] = static_cast<float>(sum[j] / static_cast<double>(rows));
    adam_step(learned_, mean, moments_, {std::span(&rate, 1), {}, ++steps_});
    for (std::size_t j = 0; j < change.size(); ++j) change[j] = learned_[j] - change[j];
    for (std::size_t i = 0; i < rows; ++i)
        add(change, birth.subspan(i * stride_, stride_), sh.subspan(i * stride_, stride_));
}

void CommonColour::add(const Coefficients& change, std::span<const float> birth, std::span<float> sh) const {
    const auto own = terms(birth.data());
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        Vec3 rest;
        for (std::size_t k = 0; k < Terms; ++k) sum += change[c * Terms + k] * own[k];
        for (std::size_t k = 0; k < 3; ++k) rest = rest + axis_[k] * (change[c * Terms + 1 + k] * ShC0);
        sh[c] += static_cast<float>(sum);
        for (std::size_t j = 3; j < stride_; j += 3)
            sh[j + c] += static_cast<float>(rest.x * birth[j] + rest.y * birth[j + 1] + rest.z * birth[j + 2]);
    }
}

}  // namespace gse::edit
