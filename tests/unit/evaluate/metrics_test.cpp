// The figures of merit on cases whose answer is known.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/evaluate/metrics.h"

namespace metrics_test {

namespace {

using namespace gse;
using namespace gse::evaluate;

constexpr double Rounding = 1e-6;  // pictures are float

Image noise(std::uint64_t seed) {
    Random random(seed);
    Image image(32, 24, 3);
    for (auto& value : image.data) value = static_cast<float>(random.uniform());
    return image;
}

Mask disc(int cx, int cy, int radius) {
    Mask mask(32, 24);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x)
            mask.at(x, y) = (x - cx) * (x - cx) + (y - cy) * (y - cy) <= radius * radius ? 1 : 0;
    return mask;
}

}  // namespace

DOCTEST_TEST_CASE("row overlap, plain and weighted") {
    const std::vector<std::uint8_t> found{1, 1, 0, 0}, truth{1, 0, 1, 0};
    const auto plain = row_overlap(found, truth);
    DOCTEST_CHECK(plain.iou == doctest::Approx(1.0 / 3));
    DOCTEST_CHECK(plain.precision == doctest::Approx(0.5));
    const auto weighted = row_overlap(found, truth, std::vector<double>{8, 1, 1, 5});
    DOCTEST_CHECK(weighted.iou == doctest::Approx(0.8));
    DOCTEST_CHECK(weighted.recall == doctest::Approx(8.0 / 9));
    const std::vector<std::uint8_t> none{0, 0, 0, 0};
    DOCTEST_CHECK(row_overlap(none, none).iou == 1);
    DOCTEST_CHECK(row_overlap(none, truth).iou == 0);
}

DOCTEST_TEST_CASE("boundary F forgives a shift within its tolerance and no more") {
    DOCTEST_CHECK(boundary_f(disc(15, 12, 6), disc(15, 12, 6)) == 1);
    DOCTEST_CHECK(boundary_f(disc(15, 12, 6), disc(16, 12, 6)) == 1);
    DOCTEST_CHECK(boundary_f(disc(8, 12, 5), disc(24, 12, 5)) == 0);
    DOCTEST_CHECK(boundary_f(Mask(32, 24), disc(15, 12, 6)) == 0);
    DOCTEST_CHECK(boundary_f(Mask(32, 24), Mask(32, 24)) == 1);
}

DOCTEST_TEST_CASE("PSNR and leak look at their region only") {
    const Image a = noise(1);
    Image b = a;
    const Mask mask = disc(15, 12, 6);
    for (std::size_t pixel = 0; pixel < b.pixel_count(); ++pixel)
        if (mask.data[pixel] != 0)
            for (std::size_t c = 0; c < 3; ++c) b.data[pixel * 3 + c] += 0.1f;
    DOCTEST_CHECK(psnr_db(a, b, {&mask, true}) == doctest::Approx(20).epsilon(1e-4));
    DOCTEST_CHECK(psnr_db(a, b, {&mask, false}) == PsnrLimitDb);
    DOCTEST_CHECK(leak_rate(a, b, {&mask, false}) == 0);
    DOCTEST_CHECK(leak_rate(a, b, {&mask, true}) == 1);
    DOCTEST_CHECK(mean_absolute_error(a, b, {&mask, true}) == doctest::Approx(0.1).epsilon(1e-4));
    DOCTEST_CHECK(mean_colour_error(a, b, {&mask, true}) ==
                  doctest::Approx(0.1 * std::sqrt(3.0)).epsilon(1e-4));
}

DOCTEST_TEST_CASE("SSIM is 1 for equal pictures, symmetric, and falls with noise") {
    const Image a = noise(1), b = noise(2);
    DOCTEST_CHECK(std::abs(ssim(a, a) - 1) < Rounding);
    DOCTEST_CHECK(std::abs(ssim(a, b) - ssim(b, a)) < Rounding);
    DOCTEST_CHECK(ssim(a, b) < 0.3);
    // A constant picture against a shifted constant has a closed form away from the border.
    const Image dark(32, 24, 3, 0.2f), light(32, 24, 3, 0.4f);
    const Mask middle = disc(15, 12, 4);
    const double expected = (2 * 0.2 * 0.4 + 1e-4) / (0.2 * 0.2 + 0.4 * 0.4 + 1e-4);
    DOCTEST_CHECK(ssim(dark, light, {&middle, true}) == doctest::Approx(expected).epsilon(1e-4));
}

DOCTEST_TEST_CASE("gradient energy is that of a ramp, falls with blur, and looks at its region only") {
    Image ramp(32, 24, 3);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < 3; ++c) ramp.at(x, y, c) = 0.01f * static_cast<float>(x + 2 * y);
    DOCTEST_CHECK(gradient_energy(ramp) == doctest::Approx(5e-4).epsilon(1e-4));
    const Image sharp = noise(4);
    Image blurred = sharp;  // the mean of each pixel and its neighbour to the right
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x + 1 < 32; ++x)
            for (int c = 0; c < 3; ++c)
                blurred.at(x, y, c) = 0.5f * (sharp.at(x, y, c) + sharp.at(x + 1, y, c));
    DOCTEST_CHECK(gradient_energy(blurred) < 0.6 * gradient_energy(sharp));
    Image faint = sharp;
    for (auto& value : faint.data) value *= 0.5f;
    DOCTEST_CHECK(gradient_energy(faint) == doctest::Approx(0.25 * gradient_energy(sharp)));
    // An edge along the rim of a region belongs to neither side.
    const Mask left = [] {
        Mask mask(32, 24);
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 16; ++x) mask.at(x, y) = 1;
        return mask;
    }();
    Image step(32, 24, 3);
    for (std::size_t p = 0; p < left.data.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) step.data[3 * p + c] = left.data[p] != 0 ? 1.0f : 0.0f;
    DOCTEST_CHECK(gradient_energy(step) > 0);
    DOCTEST_CHECK(gradient_energy(step, {&left, true}) == 0);
    DOCTEST_CHECK(gradient_energy(step, {&left, false}) == 0);
    const Mask nothing(32, 24);
    DOCTEST_CHECK(gradient_energy(sharp, {&nothing, true}) == 0);
}

DOCTEST_TEST_CASE("a changed bit of a counted row is seen") {
    GaussianData data;
    data.resize(4);
    const GaussianSet before(data);
    data.rotation[2 * 4 + 1] = -0.0f;  // equal as a number, not as bits
    const GaussianSet after(data);
    DOCTEST_CHECK(changed_rows(before, after, std::vector<std::uint8_t>{1, 1, 1, 1}) == 1);
    DOCTEST_CHECK(changed_rows(before, after, std::vector<std::uint8_t>{1, 1, 0, 1}) == 0);
}

DOCTEST_TEST_CASE("a leak is a difference above the tolerance, counted in pixels") {
    const Image a(8, 4, 3, 0.5f);
    Image b = a;
    b.data[0] += static_cast<float>(0.9 * LeakTolerance);          // below
    b.data[3 * 5 + 2] -= static_cast<float>(1.5 * LeakTolerance);  // one channel of one pixel
    DOCTEST_CHECK(leak_rate(a, b, {}) == doctest::Approx(1.0 / 32));
    DOCTEST_CHECK(changed_pixels(a, b, LeakTolerance).count() == 1);
    DOCTEST_CHECK(changed_pixels(a, b, LeakTolerance).at(5, 0) == 1);
    const Mask nothing(8, 4);
    DOCTEST_CHECK(leak_rate(a, b, {&nothing, true}) == 0);
}

DOCTEST_TEST_CASE("the outline tolerance grows with the picture and never vanishes") {
    DOCTEST_CHECK(boundary_tolerance_px(64, 64) == 1);
    DOCTEST_CHECK(boundary_tolerance_px(512, 512) ==
                  doctest::Approx(BoundaryToleranceShare * 512 * std::sqrt(2.0)));
    DOCTEST_CHECK(boundary_tolerance_px(300, 400) == doctest::Approx(BoundaryToleranceShare * 500));
}

DOCTEST_TEST_CASE("a value that is no number counts as wholly different, never as equal") {
    const Image clean(4, 4, 3, 0.5f);
    Image broken = clean;
    broken.data[0] = std::numeric_limits<float>::quiet_NaN();
    broken.data[1] = std::numeric_limits<float>::infinity();
    DOCTEST_CHECK(psnr_db(clean, broken) == doctest::Approx(-10 * std::log10(2.0 / 48)));
    DOCTEST_CHECK(psnr_db(broken, broken) == doctest::Approx(-10 * std::log10(2.0 / 48)));
    DOCTEST_CHECK(mean_absolute_error(clean, broken) == doctest::Approx(2.0 / 48));
    DOCTEST_CHECK(leak_rate(clean, broken, {}, 0.1) == doctest::Approx(1.0 / 16));
    DOCTEST_CHECK(std::isfinite(mean_colour_error(clean, broken, {})));
}

DOCTEST_TEST_CASE("drift follows the rows through an edit that removes and adds some") {
    GaussianData data;
    data.resize(4);
    for (std::size_t i = 0; i < data.position.size(); ++i) data.position[i] = static_cast<float>(i);
    const GaussianSet before(data);
    // Row 1 is removed, the others move up, one row is new.
    GaussianData edited;
    edited.resize(4);
    const auto copy = [&](std::size_t from, std::size_t to) {
        for (std::size_t c = 0; c < 3; ++c) edited.position[to * 3 + c] = data.position[from * 3 + c];
        for (std::size_t c = 0; c < 4; ++c) edited.rotation[to * 4 + c] = data.rotation[from * 4 + c];
    };
    copy(0, 0);
    copy(2, 1);
    copy(3, 2);
    const std::vector<std::int64_t> moved{0, -1, 1, 2};
    DOCTEST_CHECK(drifted_rows(before, GaussianSet(edited), moved, std::vector<std::uint8_t>{0, 1, 0, 0}) ==
                  0);
    DOCTEST_CHECK(drifted_rows(before, GaussianSet(edited), moved, std::vector<std::uint8_t>{0, 0, 0, 0}) ==
                  1);
    edited.opacity_logit[2] = 1;  // row 3 of before
    DOCTEST_CHECK(drifted_rows(before, GaussianSet(edited), moved, std::vector<std::uint8_t>{0, 1, 0, 0}) ==
                  1);
    DOCTEST_CHECK(drifted_rows(before, GaussianSet(edited), moved, std::vector<std::uint8_t>{0, 1, 0, 1}) ==
                  0);
}

}  // namespace metrics_test
