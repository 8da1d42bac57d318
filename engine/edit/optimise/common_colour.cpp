// Terms of the affine map, its gradient and its step.
#include "engine/edit/optimise/common_colour.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/math/sh.h"

namespace gse::edit {
namespace {

constexpr double ConstantShare = 0.5;  // of the constant term: low, so that black stays black
constexpr double FirstShare = 1.5;     // of the first axis, along which the colours change most
constexpr double DarkestLabel = 0.1;   // darker labels count as this bright
// Spread of the first axis: what spreads less is noise, and is not blown up further.
constexpr double LeastSpread = 0.03;

Vec3 base_colour(const float* sh) {
    return {colour_from_sh(sh[0]), colour_from_sh(sh[1]), colour_from_sh(sh[2])};
}

/// Second moments of the colours about black, the mean over the rows and over all viewing directions.
/// Harmonics are orthonormal, so a coefficient above DC adds its square over 4 pi = ShC0^2.
Mat3 second_moments(std::span<const float> birth, std::size_t stride) {
    Mat3 sum;
    const std::size_t rows = birth.size() / stride;
    const auto add = [&](const Vec3& colour) {
        for (int row = 0; row < 3; ++row)
            for (int column = row; column < 3; ++column)
                sum(row, column) += colour[row] * colour[column] / static_cast<double>(rows);
    };
    for (std::size_t i = 0; i < rows; ++i) {
        const float* sh = &birth[i * stride];
        add(base_colour(sh));
        for (std::size_t j = 3; j < stride; j += 3) add(Vec3{sh[j], sh[j + 1], sh[j + 2]} * ShC0);
    }
    return sum;
}

}  // namespace

CommonColour::CommonColour(std::span<const float> birth, std::size_t stride) : stride_(stride) {
    GSE_CHECK_EQ(birth.size() % stride, std::size_t{0});
    const SymmetricEigen eigen = symmetric_eigen(second_moments(birth, stride));
    const double first = std::max(std::sqrt(std::max(eigen.value[0], 0.0)), DarkestLabel);
    for (std::size_t k = 0; k < 3; ++k) {
        const double spread =
            k == 0 ? first : std::max(std::sqrt(std::max(eigen.value[k], 0.0)), LeastSpread * first);
        axis_[k] = eigen.axis[k] * ((k == 0 ? FirstShare : 1.0) / spread);
    }
    for (std::size_t i = 0; i < birth.size(); i += stride)
        for (std::size_t k = 0; k < 3; ++k) {
            const double along = dot(axis_[k], base_colour(&birth[i]));
            low_[k] = i == 0 ? along : std::min(low_[k], along);
            high_[k] = i == 0 ? along : std::max(high_[k], along);
        }
}

std::array<double, CommonColour::Terms> CommonColour::terms(const float* birth) const {
    const Vec3 colour = base_colour(birth);
    const auto along = [&](std::size_t k) { return std::clamp(dot(axis_[k], colour), low_[k], high_[k]); };
    return {ConstantShare, along(0), along(1), along(2)};
}

void CommonColour::step(std::span<const float> gradient, std::span<const float> birth, std::span<float> sh,
                        double rate) {
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
    for (std::size_t j = 0; j < sum.size(); ++j)
        mean[j] = static_cast<float>(sum[j] / static_cast<double>(rows));
    adam_step(learned_, mean, moments_, {std::span(&rate, 1), {}, ++steps_});
    for (std::size_t j = 0; j < change.size(); ++j) change[j] = learned_[j] - change[j];
    add(change, birth, sh);
}

void CommonColour::add(const Coefficients& change, std::span<const float> birth, std::span<float> sh) const {
    std::array<Vec3, 3> rest{};  // A's rows
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 3; ++k) rest[c] = rest[c] + axis_[k] * (change[c * Terms + 1 + k] * ShC0);
    for (std::size_t i = 0; i < sh.size(); i += stride_) {
        const auto own = terms(&birth[i]);
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t k = 0; k < Terms; ++k) sum += change[c * Terms + k] * own[k];
            sh[i + c] += static_cast<float>(sum);
            for (std::size_t j = i + 3; j < i + stride_; j += 3)
                sh[j + c] += static_cast<float>(dot(rest[c], {birth[j], birth[j + 1], birth[j + 2]}));
        }
    }
}

}  // namespace gse::edit
