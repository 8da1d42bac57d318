// Splats no view sees take the label of the seen splats around them, and only of those.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/base/random.h"
#include "engine/localize/spread.h"

namespace {

using namespace gse;

constexpr std::size_t PerBall = 400;

/// Two balls of rows, the first labelled; every third row is unseen.
struct Balls {
    GaussianData data;
    localize::LabelWeights weights;
    Balls() {
        Random random(3);
        data.resize(2 * PerBall);
        weights.weight.assign(2 * PerBall, 0);
        weights.evidence.assign(2 * PerBall, 0);
        for (std::size_t row = 0; row < 2 * PerBall; ++row) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                data.position[row * 3 + axis] = static_cast<float>(random.uniform(-1, 1));
            data.position[row * 3] += row < PerBall ? -2.0f : 2.0f;
            if (row % 3 == 0) continue;
            weights.evidence[row] = 5;
            weights.weight[row] = row < PerBall ? 0.9f : 0.1f;
        }
    }
};

}  // namespace

DOCTEST_TEST_CASE("unseen rows take the opinion of their own ball") {
    Balls balls;
    const auto before = balls.weights;
    localize::spread_to_unseen(spans(balls.data), {}, balls.weights);
    const auto label = localize::label_from_weights("ball", balls.weights, 0.5, 0.5);
    for (std::size_t row = 0; row < 2 * PerBall; ++row) {
        DOCTEST_CHECK((*label.bits)[row] == (row < PerBall ? 1 : 0));
        if (row % 3 != 0) DOCTEST_CHECK(balls.weights.weight[row] == before.weight[row]);   // seen rows keep their own
    }
    DOCTEST_CHECK(balls.weights.evidence == before.evidence);
}

DOCTEST_TEST_CASE("no opinion comes from out of reach, and broken rows ask nobody") {
    Balls balls;
    balls.data.position[0] = 500;
    balls.data.position[3 * 3] = std::numeric_limits<float>::quiet_NaN();
    localize::spread_to_unseen(spans(balls.data), {}, balls.weights);
    DOCTEST_CHECK(balls.weights.inferred[0] == 0);
    DOCTEST_CHECK(balls.weights.inferred[3] == 0);
    DOCTEST_CHECK(balls.weights.inferred[6] == 1);
}

DOCTEST_TEST_CASE("without a labelled or without a seen row nothing changes") {
    Balls balls;
    for (auto& evidence : balls.weights.evidence) evidence = 0;
    const auto before = balls.weights.weight;
    localize::spread_to_unseen(spans(balls.data), {}, balls.weights);
    DOCTEST_CHECK(balls.weights.weight == before);
}
