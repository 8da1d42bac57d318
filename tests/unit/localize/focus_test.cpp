// Cameras move in on what is labelled.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/localize/focus.h"

namespace focus_test {

namespace {

/// A wide floor of 400 rows and a small ball of 100 labelled rows at (2, -0.5, 1) with radius 0.4.
gse::GaussianSet floor_and_ball(std::vector<std::uint8_t>& bits) {
    gse::GaussianData data;
    data.resize(500);
    for (std::size_t row = 0; row < 500; ++row) {
        const double angle = 0.7 * static_cast<double>(row);
        const bool ball = row >= 400;
        const double height = ball ? std::sin(1.3 * static_cast<double>(row)) : 0;
        const double reach =
            ball ? 0.4 * std::sqrt(1 - height * height) : 10 * std::sqrt(static_cast<double>(row) / 400);
        data.position[row * 3] = static_cast<float>((ball ? 2 : 0) + reach * std::cos(angle));
        data.position[row * 3 + 1] = static_cast<float>(ball ? -0.5 + 0.4 * height : 0);
        data.position[row * 3 + 2] = static_cast<float>((ball ? 1 : 0) + reach * std::sin(angle));
        data.opacity_logit[row] = 3;
        data.rotation[row * 4] = 1;
        bits.push_back(ball ? 1 : 0);
    }
    return gse::GaussianSet(std::move(data));
}

}  // namespace

DOCTEST_TEST_CASE("the focused orbit frames the labelled ball") {
    std::vector<std::uint8_t> bits;
    const auto set = floor_and_ball(bits);
    gse::OrbitParameters base;
    base.radius = 25;
    const auto focused = gse::localize::focus_orbit(set, bits, base);
    DOCTEST_CHECK(gse::length(focused.centre - gse::Vec3{2, -0.5, 1}) < 0.1);
    DOCTEST_CHECK(gse::localize::worth_refocusing(base, focused));
    // Every labelled row is inside the picture and the ball fills at least a third of its width.
    const auto camera = gse::orbit_camera(focused, 0.4, 100, 100);
    double least = 100, most = 0;
    for (std::size_t row = 400; row < 500; ++row) {
        const auto* p = &set.position()[row * 3];
        const auto q = camera.to_camera({p[0], p[1], p[2]});
        const double x = camera.fx * q.x / q.z + camera.cx;
        DOCTEST_CHECK(q.z > 0);
        least = std::min(least, x);
        most = std::max(most, x);
    }
    DOCTEST_CHECK(least > 0);
    DOCTEST_CHECK(most < 100);
    DOCTEST_CHECK(most - least > 33);
}

DOCTEST_TEST_CASE("head room lifts the picture's middle above the region's, along the world's up") {
    std::vector<std::uint8_t> bits;
    const auto set = floor_and_ball(bits);
    gse::OrbitParameters base;
    base.radius = 25;
    const auto plain = gse::localize::focus_orbit(set, bits, base);
    gse::localize::FocusParameters framing;
    framing.head_room = 0.5;  // of the extent: half the ball's height
    const auto lifted = gse::localize::focus_orbit(set, bits, base, framing);
    const auto shift = lifted.centre - plain.centre;
    DOCTEST_CHECK(lifted.radius == plain.radius);
    DOCTEST_CHECK(gse::dot(shift, gse::normalized(base.up)) == doctest::Approx(gse::length(shift)));
    const auto camera = gse::orbit_camera(lifted, 0, 100, 100);
    const auto middle = camera.to_camera(plain.centre);
    DOCTEST_CHECK(camera.fy * middle.y / middle.z + camera.cy > 60);  // the ball is in the lower half
}

DOCTEST_TEST_CASE("without a label, or with everything labelled already in frame, nothing moves") {
    std::vector<std::uint8_t> bits;
    const auto set = floor_and_ball(bits);
    gse::OrbitParameters base;
    base.radius = 25;
    const std::vector<std::uint8_t> none(500, 0);
    DOCTEST_CHECK(gse::localize::focus_orbit(set, none, base).radius == base.radius);
    const std::vector<std::uint8_t> all(500, 1);
    const auto focused = gse::localize::focus_orbit(set, all, base);
    DOCTEST_CHECK_FALSE(
        gse::localize::worth_refocusing(focused, gse::localize::focus_orbit(set, all, focused)));
}

}  // namespace focus_test
