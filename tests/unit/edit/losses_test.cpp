// Adam against a hand calculation, the generation schedule against its closed form, SSIM against finite
// differences.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "engine/base/random.h"
#include "engine/edit/optimise/preservation_loss.h"
#include "engine/edit/optimise/working_set.h"

namespace losses_test {

namespace {

using namespace gse;

constexpr double FloatRounding = 1e-5;  // results are stored as float
constexpr double Step = 1e-3;           // central differences of a smooth function, values are float
constexpr double GradientTolerance = 2e-2;

Image random_image(int width, int height, std::uint64_t seed) {
    Random random(seed);
    Image image(width, height, 3);
    for (auto& value : image.data) value = static_cast<float>(random.uniform());
    return image;
}

/// SSIM of one channel by the definition: an 11x11 window around every pixel, nothing beyond the border.
double plain_ssim(const Image& a, const Image& b, int channel) {
    std::array<double, 11> window{};
    double sum = 0;
    for (int i = 0; i < 11; ++i)
        sum += window[static_cast<std::size_t>(i)] = std::exp(-(i - 5) * (i - 5) / 4.5);
    double total = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
            for (int v = std::max(0, y - 5); v <= std::min(a.height - 1, y + 5); ++v)
                for (int u = std::max(0, x - 5); u <= std::min(a.width - 1, x + 5); ++u) {
                    const double w = window[static_cast<std::size_t>(v - y + 5)] *
                                     window[static_cast<std::size_t>(u - x + 5)] / (sum * sum);
                    const double p = a.at(u, v, channel), q = b.at(u, v, channel);
                    ma += w * p, mb += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
                }
            total += (2 * ma * mb + 1e-4) * (2 * (ab - ma * mb) + 9e-4) /
                     ((ma * ma + mb * mb + 1e-4) * (aa - ma * ma + bb - mb * mb + 9e-4));
        }
    return total / (a.width * a.height);
}

double plain_loss(const Image& image, const Image& target) {
    double l1 = 0;
    for (std::size_t i = 0; i < image.data.size(); ++i)
        l1 += std::abs(static_cast<double>(image.data[i]) - target.data[i]);
    l1 /= static_cast<double>(image.data.size());
    const double ssim =
        (plain_ssim(image, target, 0) + plain_ssim(image, target, 1) + plain_ssim(image, target, 2)) / 3;
    return 10 * (0.8 * l1 + 0.2 * (1 - ssim));
}

}  // namespace

DOCTEST_TEST_CASE("Adam follows its formula") {
    std::vector<float> parameters{1, -2};
    edit::AdamMoments moments;
    const std::array<double, 2> rates{0.1, 0.01};
    // Hand calculation with g1 = (0.5, -4), g2 = (0.25, 0).
    edit::adam_step(parameters, std::array<float, 2>{0.5f, -4}, moments, {rates, {}, 1});
    DOCTEST_CHECK(parameters[0] == doctest::Approx(0.9).epsilon(FloatRounding));
    DOCTEST_CHECK(parameters[1] == doctest::Approx(-1.99).epsilon(FloatRounding));
    edit::adam_step(parameters, std::array<float, 2>{0.25f, 0}, moments, {rates, {}, 2});
    const double first = (0.9 * 0.05 + 0.1 * 0.25) / (1 - 0.81);
    const double second = (0.999 * 0.001 * 0.25 + 0.001 * 0.0625) / (1 - 0.998001);
    DOCTEST_CHECK(parameters[0] ==
                  doctest::Approx(0.9 - 0.1 * first / std::sqrt(second)).epsilon(FloatRounding));
    const double still_first = 0.9 * -0.4 / 0.19, still_second = 0.999 * 0.016 / 0.001999;
    // Momentum moves the second value although its gradient is zero now.
    DOCTEST_CHECK(
        parameters[1] ==
        doctest::Approx(-1.99 - 0.01 * still_first / std::sqrt(still_second)).epsilon(FloatRounding));
}

DOCTEST_TEST_CASE("Adam's per-row factor scales the step and zero stops it") {
    std::vector<float> parameters{0, 0, 0};
    edit::AdamMoments moments;
    const std::array<double, 1> rate{0.1};
    const std::array<float, 3> factor{1, 0.5f, 0};
    edit::adam_step(parameters, std::array<float, 3>{1, 1, 1}, moments, {rate, factor, 1});
    DOCTEST_CHECK(parameters[0] == doctest::Approx(-0.1).epsilon(FloatRounding));
    DOCTEST_CHECK(parameters[1] == doctest::Approx(-0.05).epsilon(FloatRounding));
    DOCTEST_CHECK(parameters[2] == 0);
}

DOCTEST_TEST_CASE("the generation schedule is its closed form (METHOD.md, Anchors)") {
    for (const auto& [g0, a0, m] :
         {std::array{0.05, 0.1, 1.3}, {1.0, 0.1, 2.0}, {0.0, 0.02, 1.3}, {0.01, 0.01, 1.3}}) {
        edit::EditRequest request;
        request.anchor_first = g0;
        request.anchor_start = a0;
        request.anchor_growth = m;
        edit::GenerationSchedule schedule(request);
        DOCTEST_CHECK(schedule.weight(0) == g0);
        for (int k = 1; k <= 30; ++k) {
            DOCTEST_CHECK(schedule.advance() == k);
            DOCTEST_CHECK(schedule.newest() == k);
            DOCTEST_CHECK(schedule.weight(0) == doctest::Approx(std::min(10.0, g0 * std::pow(m, k))));
            for (int i = 1; i < k; ++i)
                DOCTEST_CHECK(schedule.weight(i) ==
                              doctest::Approx(std::min(10.0, a0 * std::pow(m, k - 1 - i))));
            DOCTEST_CHECK(schedule.weight(k) == 0);
        }
    }
}

DOCTEST_TEST_CASE("the preservation loss and its gradient agree with the definition") {
    const Image image = random_image(17, 13, 1), original = random_image(17, 13, 2);
    edit::PreservationLoss preservation({0.8, 0.2, 10});
    Image gradient(17, 13, 3);
    const Mask nothing(17, 13);
    const double loss = preservation.add_gradient(image, original, nothing, gradient);
    DOCTEST_CHECK(loss == doctest::Approx(plain_loss(image, original)).epsilon(1e-5));
    double largest = 0;
    for (const float value : gradient.data) largest = std::max(largest, std::abs(static_cast<double>(value)));
    Random random(3);
    for (int trial = 0; trial < 40; ++trial) {
        const std::size_t i = random.below(image.data.size());
        Image up = image, down = image;
        up.data[i] += static_cast<float>(Step);
        down.data[i] -= static_cast<float>(Step);
        const double width = static_cast<double>(up.data[i]) - down.data[i];
        const double slope = (plain_loss(up, original) - plain_loss(down, original)) / width;
        DOCTEST_CHECK(std::abs(gradient.data[i] - slope) < GradientTolerance * largest);
    }
}

DOCTEST_TEST_CASE(
    "a change in a corner costs what the definition says, and pushes nothing farther off than two windows") {
    const Image original = random_image(60, 50, 6);
    for (const auto& [x0, y0] : {std::array{0, 0}, {57, 47}, {30, 20}, {0, 25}}) {
        Image image = original;
        const Image other = random_image(60, 50, 7);
        for (int y = y0; y < y0 + 3; ++y)
            for (int x = x0; x < x0 + 3; ++x)
                for (int c = 0; c < 3; ++c) image.at(x, y, c) = other.at(x, y, c);
        edit::PreservationLoss preservation({0.8, 0.2, 10});
        Image gradient(60, 50, 3);
        const double loss = preservation.add_gradient(image, original, Mask(60, 50), gradient);
        DOCTEST_CHECK(loss == doctest::Approx(plain_loss(image, original)).epsilon(1e-5));
        double largest = 0;
        for (const float value : gradient.data)
            largest = std::max(largest, std::abs(static_cast<double>(value)));
        for (int y = 0; y < 50; ++y)
            for (int x = 0; x < 60; ++x) {
                const bool near = x >= x0 - 10 && x < x0 + 13 && y >= y0 - 10 && y < y0 + 13;
                if (!near) DOCTEST_CHECK(gradient.at(x, y, 0) == 0);
                const auto i = (static_cast<std::size_t>(y) * 60 + static_cast<std::size_t>(x)) * 3;
                if (!near || (x + 3 * y) % 7 != 0) continue;
                Image up = image, down = image;
                up.data[i] += static_cast<float>(Step);
                down.data[i] -= static_cast<float>(Step);
                const double slope = (plain_loss(up, original) - plain_loss(down, original)) /
                                     (static_cast<double>(up.data[i]) - down.data[i]);
                if (image.data[i] != original.data[i])
                    DOCTEST_CHECK(std::abs(gradient.data[i] - slope) < GradientTolerance * largest);
            }
    }
}

DOCTEST_TEST_CASE("the pseudo ground truth leaves the inside of the mask alone but for the window's reach") {
    const Image image = random_image(40, 24, 4), original = random_image(40, 24, 5);
    Mask mask(40, 24);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 20; ++x) mask.at(x, y) = 1;
    edit::PreservationLoss preservation({0.8, 0.2, 10});
    Image gradient(40, 24, 3);
    const double loss = preservation.add_gradient(image, original, mask, gradient);
    DOCTEST_CHECK(loss > 0);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 10; ++x)  // farther than two window radii from the rim: nothing reaches here
            DOCTEST_CHECK(gradient.at(x, y, 1) == 0);
    Image again(40, 24, 3);
    DOCTEST_CHECK(preservation.add_gradient(image, original, Mask(40, 24, 1), again) == doctest::Approx(0));
    for (const float value : again.data) DOCTEST_CHECK(std::abs(value) < 1e-7);  // float rounding of the blur
    Image third(40, 24, 3);
    DOCTEST_CHECK(preservation.add_gradient(original, original, Mask(40, 24), third) == doctest::Approx(0));
}

DOCTEST_TEST_CASE("trust scales what a pixel's absolute difference counts") {
    const Image image = random_image(9, 7, 6), original = random_image(9, 7, 7);
    const Mask nothing(9, 7);
    edit::PreservationLoss preservation({1, 0, 10});
    Image full(9, 7, 3), weighed(9, 7, 3), trust(9, 7, 1);
    std::fill(trust.data.begin(), trust.data.end(), 0.25f);
    trust.data[5] = 1;
    const double loss = preservation.add_gradient(image, original, nothing, full);
    const double trusted = preservation.add_gradient(image, original, nothing, weighed, &trust);
    double expected = 0;
    for (std::size_t i = 0; i < full.data.size(); ++i) {
        DOCTEST_CHECK(weighed.data[i] == doctest::Approx(trust.data[i / 3] * full.data[i]));
        expected += 10.0 / static_cast<double>(full.data.size()) * static_cast<double>(trust.data[i / 3]) *
                    std::abs(static_cast<double>(image.data[i]) - static_cast<double>(original.data[i]));
    }
    DOCTEST_CHECK(trusted == doctest::Approx(expected).epsilon(1e-5));
    DOCTEST_CHECK(trusted < loss);
}

}  // namespace losses_test
