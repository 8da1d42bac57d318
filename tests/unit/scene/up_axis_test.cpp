// Guess of up from what stands: it turns with the scene, and is not sure of what looks alike from all sides.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.h"
#include "engine/math/sh.h"
#include "engine/scene/layout/up_axis.h"

namespace up_axis_test {

namespace {

using namespace gse;

/// Adds a flat splat of a surface.
void add(GaussianData& data, const Vec3& at, int normal_axis, double brightness) {
    constexpr double Size = 0.03, Thickness = 0.002;
    const std::size_t row = data.size();
    data.resize(row + 1);
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t i = row * 3 + static_cast<std::size_t>(axis);
        data.position[i] = static_cast<float>(at[axis]);
        data.log_scale[i] = static_cast<float>(std::log(axis == normal_axis ? Thickness : Size));
        data.sh[i] = static_cast<float>((brightness - 0.5) / 0.28209479177387814);
    }
    data.rotation[row * 4] = 1;
    data.opacity_logit[row] = 3;
}

/// Steps of three boxes that grow smaller along `up`, brighter where they face up. Nothing is seen from
/// below.
GaussianSet steps(std::size_t up) {
    const int axis = static_cast<int>(up / 2);
    const double sign = up % 2 == 1 ? -1 : 1;
    GaussianData data;
    Random random(7);
    for (const int level : {0, 1, 2}) {
        const double half = 1 - 0.3 * level;
        for (int i = 0; i < 2500; ++i) {
            Vec3 at;
            const double u = half * (2 * random.uniform() - 1), v = half * (2 * random.uniform() - 1);
            const int face = i % 5;  // four walls and the top
            const double height = 0.5 * level + (face == 4 ? 0.5 : 0.25 * (v / half + 1));
            at[axis] = sign * (height - 0.7);
            const int first = (axis + 1) % 3, second = (axis + 2) % 3;
            at[first] = face == 4 ? v : face < 2 ? (face == 0 ? half : -half) : u;
            at[second] = face == 4 ? u : face < 2 ? u : (face == 2 ? half : -half);
            add(data, at, face == 4 ? axis : face < 2 ? first : second, face == 4 ? 0.7 : 0.4);
        }
    }
    return GaussianSet(std::move(data));
}

}  // namespace

DOCTEST_TEST_CASE("steps that are lit from above stand up, whichever axis that is") {
    for (std::size_t up = 0; up < Directions; ++up) {
        const UpGuess guess = guess_up_axis(steps(up));
        DOCTEST_CAPTURE(direction_name(up));
        DOCTEST_CHECK(guess.up() == direction(up));
        DOCTEST_CHECK(guess.sure());
        DOCTEST_CHECK(guess_up_axis(steps(up)).likelihood == guess.likelihood);
    }
}

DOCTEST_TEST_CASE("a guess without evidence is habit, and not sure") {
    GaussianData ball;
    Random random(8);
    while (ball.size() < 5000) {
        const Vec3 at{2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
        if (length(at) > 0.1 && length(at) < 1)
            add(ball, normalized(at), static_cast<int>(ball.size() % 3), 0.5);
    }
    for (const GaussianSet& set : {GaussianSet(ball), GaussianSet()}) {
        const UpGuess guess = guess_up_axis(set);
        DOCTEST_CHECK_FALSE(guess.sure());
        double sum = 0;
        for (const double likelihood : guess.likelihood) sum += likelihood;
        DOCTEST_CHECK(sum == doctest::Approx(1));
    }
    DOCTEST_CHECK(guess_up_axis(GaussianSet()).up() == Vec3{0, -1, 0});
}

DOCTEST_TEST_CASE("splats that are left out do not count, and broken ones harm nothing") {
    const GaussianSet set = steps(4);
    GaussianData data = set.to_data();
    std::vector<std::uint8_t> skip(data.size(), 0);
    for (int i = 0; i < 3000; ++i) {
        add(data, {50.0 + i, 0, 0}, 0, 0.9);
        skip.push_back(1);
    }
    DOCTEST_CHECK(guess_up_axis(GaussianSet(data), skip).likelihood == guess_up_axis(set).likelihood);
    for (std::size_t row = 0; row < 500; ++row) data.position[row * 3] = std::nanf("");
    DOCTEST_CHECK(guess_up_axis(GaussianSet(data), skip).up() == Vec3{0, 0, 1});
}

}  // namespace up_axis_test
