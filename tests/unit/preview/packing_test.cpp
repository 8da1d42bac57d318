// Halfs and packed rows.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/base/random.h"
#include "engine/preview/packing.h"
#include "engine/preview/resolve.h"

namespace packing_test {

using namespace gse;

namespace {

double value_of(std::uint16_t half) {
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    const double sign = (half & 0x8000) != 0 ? -1 : 1;
    if (exponent == 31) return mantissa != 0 ? NAN : sign * INFINITY;
    return sign * (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25));
}

}  // namespace

DOCTEST_TEST_CASE("halfs are the nearest ones, in long and in short runs") {
    Random random(1);
    std::vector<float> values{0,     -0.0f,         1,       -1,      65504,    65520, 1e9f,
                              -1e9f, 5.9604645e-8f, 2.9e-8f, 6.1e-5f, 0.333333f};
    for (int i = 0; i < 5000; ++i)
        values.push_back(static_cast<float>(random.normal() * std::exp2(random.uniform(-26, 17))));
    std::vector<std::uint16_t> long_run(values.size());
    preview::to_half(values.data(), values.size(), long_run.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint16_t single = 0;
        preview::to_half(&values[i], 1, &single);  // the plain version
        DOCTEST_CHECK(single == long_run[i]);
        const double limited = std::min(std::max(static_cast<double>(values[i]), -65504.0), 65504.0);
        const double step =
            std::max(std::exp2(std::floor(std::log2(std::abs(limited) + 1e-300)) - 10), std::exp2(-24));
        DOCTEST_CHECK(std::abs(value_of(single) - limited) <= step / 2);
    }
}

DOCTEST_TEST_CASE("packed geometry is activated, and rows that cannot be drawn are invisible") {
    GaussianData data;
    data.resize(3);
    data.position = {1, 2, 3, NAN, 0, 0, 0, 0, 0};
    data.log_scale = {0, std::log(2.0f), -1e30f, 0, 0, 0, 50, 0, 0};
    data.rotation = {0, 3, 0, 4, 1, 0, 0, 0, 0, 0, 0, 0};
    data.opacity_logit = {0, 5, std::numeric_limits<float>::infinity()};
    const GaussianSet set{data};
    std::vector<float> out(36);
    preview::pack_geometry(set, 0, 3, out.data());
    DOCTEST_CHECK(out[2] == 3);
    DOCTEST_CHECK(out[3] == 0.5f);
    DOCTEST_CHECK(out[5] == doctest::Approx(0.6));
    DOCTEST_CHECK(out[7] == doctest::Approx(0.8));
    DOCTEST_CHECK(out[9] == doctest::Approx(2));
    DOCTEST_CHECK(out[10] == 0);
    DOCTEST_CHECK(out[12 + 3] == 0);  // NaN position
    DOCTEST_CHECK(out[24 + 3] == 1);  // certain
    DOCTEST_CHECK(out[24 + 4] == 1);  // zero quaternion: identity
    DOCTEST_CHECK(std::isfinite(out[24 + 8]));
}

DOCTEST_TEST_CASE("the colour map grows lighter") {
    float before = -1;
    for (int i = 0; i <= 100; ++i) {
        const auto colour = preview::map_colour(static_cast<float>(i) / 100);
        const float lightness = 0.2126f * colour[0] + 0.7152f * colour[1] + 0.0722f * colour[2];
        DOCTEST_CHECK(lightness > before);
        before = lightness;
    }
}

DOCTEST_TEST_CASE("labels tint in proportion, and what is transparent keeps its colour") {
    preview::Display display;
    display.mode = preview::Mode::Labels;
    display.tint = {1, 0, 0};
    display.tint_strength = 0.5f;
    preview::PixelSums sums{0.4f, 0.4f, 0.4f, 0.8f, 0, 0.8f};  // grey 0.5, all of it labelled
    const auto all = preview::resolve_pixel(sums, display, 1);
    DOCTEST_CHECK(all[0] == doctest::Approx(0.8 * 0.75));
    DOCTEST_CHECK(all[1] == doctest::Approx(0.8 * 0.25));
    sums.value = 0;
    display.transparent = true;
    const auto none = preview::resolve_pixel(sums, display, 1);
    DOCTEST_CHECK(none[0] == doctest::Approx(0.5));
    DOCTEST_CHECK(none[3] == doctest::Approx(0.8));
}

DOCTEST_TEST_CASE("a labelled red thing is hatched, a grey one is not") {
    constexpr int Side = 20, Seen = 50;  // of 255
    preview::Display display;
    display.mode = preview::Mode::Labels;
    display.tint_strength = 0.6f;
    ThreadPool pool(1);
    const auto spread = [&](const std::array<float, 3>& colour) {  // between the pixels, of any channel
        Image picture(Side, Side, 3), ones(Side, Side, 1, 1.0f);
        for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = colour[i % 3];
        std::vector<std::uint8_t> rgba;
        preview::resolve({&picture, &ones, nullptr, &ones}, display, 1, pool, rgba);
        int most = 0;
        for (std::size_t i = 0; i < rgba.size(); ++i)
            most = std::max(most, std::abs(static_cast<int>(rgba[i]) - static_cast<int>(rgba[i % 4])));
        return most;
    };
    DOCTEST_CHECK(spread({0.8f, 0.1f, 0.1f}) > Seen);
    DOCTEST_CHECK(spread({1.0f, 0.45f, 0.1f}) > Seen);
    DOCTEST_CHECK(spread({0.5f, 0.5f, 0.5f}) == 0);
    DOCTEST_CHECK(spread({0.2f, 0.3f, 0.9f}) == 0);
}

DOCTEST_TEST_CASE("the tint shows on things of every colour, its own hue among them") {
    constexpr float LeastSeen = 0.25f;  // of a channel: an eye sees a tenth at once, on a textured thing too
    preview::Display display;
    display.mode = preview::Mode::Labels;
    display.tint_strength = 0.6f;  // as the window has it
    using Colour = std::array<float, 3>;
    for (const Colour& colour :
         {Colour{0.8f, 0.1f, 0.1f}, Colour{0.5f, 0.05f, 0.05f}, Colour{1.0f, 0.45f, 0.1f},
          Colour{0.9f, 0.35f, 0.25f}, Colour{0.83f, 0.62f, 0.2f}, Colour{0.2f, 0.3f, 0.9f},
          Colour{0.2f, 0.7f, 0.2f}, Colour{0.5f, 0.5f, 0.5f}, Colour{0.45f, 0.3f, 0.2f}}) {
        preview::PixelSums sums{colour[0], colour[1], colour[2], 1, 0, 0};
        const auto plain = preview::resolve_pixel(sums, display, 1);
        sums.value = 1;
        const auto tinted = preview::resolve_pixel(sums, display, 1, true);
        float change = 0, before = 0, after = 0;
        for (std::size_t k = 0; k < 3; ++k) change = std::max(change, std::abs(tinted[k] - plain[k]));
        DOCTEST_CAPTURE(colour[0]);
        DOCTEST_CAPTURE(colour[1]);
        DOCTEST_CHECK(change > LeastSeen);
        before = plain[0] - plain[2], after = tinted[0] - tinted[2];
        // Red and orange turn cooler; any other colour turns warmer.
        const bool warm = colour[0] - colour[2] > 0.4f;
        DOCTEST_CHECK((warm ? after < before : after > before));
    }
}

}  // namespace packing_test
