// Splats no view sees take the label of the seen splats around them, and only of those.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/random.h"
#include "engine/localize/propagate_labels.h"

namespace spread_test {

namespace {

using namespace gse;

constexpr std::size_t PerBall = 400;

/// Two balls of rows, the first labelled; every third row is unseen.
struct Balls {
    GaussianData data;
    LabelField field;
    Balls() {
        Random random(3);
        data.resize(2 * PerBall);
        field.probability.assign(2 * PerBall, 0);
        field.coverage.assign(2 * PerBall, 0);
        for (std::size_t row = 0; row < 2 * PerBall; ++row) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                data.position[row * 3 + axis] = static_cast<float>(random.uniform(-1, 1));
            data.position[row * 3] += row < PerBall ? -2.0f : 2.0f;
            if (row % 3 == 0) continue;
            field.coverage[row] = 5;
            field.probability[row] = row < PerBall ? 0.9f : 0.1f;
        }
    }
};

double distance_of(const GaussianData& data, std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        sum += std::pow(double{data.position[a * 3 + axis]} - data.position[b * 3 + axis], 2);
    return std::sqrt(sum);
}

double plain_reach(const GaussianData& data, const LabelField& field,
                   const localize::SpreadParameters& parameters) {
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double low = 1e9, high = -1e9;
        for (std::size_t row = 0; row < field.probability.size(); ++row) {
            if (field.coverage[row] <= parameters.least_coverage ||
                field.probability[row] <= parameters.threshold)
                continue;
            low = std::min<double>(low, data.position[row * 3 + axis]);
            high = std::max<double>(high, data.position[row * 3 + axis]);
        }
        squared += (high - low) * (high - low);
    }
    return parameters.reach_share * std::sqrt(squared);
}

}  // namespace

DOCTEST_TEST_CASE("unseen rows take the opinion of their own ball") {
    Balls balls;
    const auto before = balls.field;
    balls.field = localize::propagate_labels_knn(spans(balls.data), {}, balls.field);
    const auto label = localize::bits(balls.field, 0.5, 0.5);
    for (std::size_t row = 0; row < 2 * PerBall; ++row) {
        DOCTEST_CHECK(label[row] == (row < PerBall ? 1 : 0));
        if (row % 3 != 0)
            // Seen rows keep their own.
            DOCTEST_CHECK(balls.field.probability[row] == before.probability[row]);
    }
    DOCTEST_CHECK(balls.field.coverage == before.coverage);
}

DOCTEST_TEST_CASE("no opinion comes from out of reach, and broken rows ask nobody") {
    Balls balls;
    balls.data.position[0] = 500;
    balls.data.position[3 * 3] = std::numeric_limits<float>::quiet_NaN();
    balls.field = localize::propagate_labels_knn(spans(balls.data), {}, balls.field);
    DOCTEST_CHECK(balls.field.inferred[0] == 0);
    DOCTEST_CHECK(balls.field.inferred[3] == 0);
    DOCTEST_CHECK(balls.field.inferred[6] == 1);
}

DOCTEST_TEST_CASE("the opinion is that of the nearest within reach, as measuring all distances tells") {
    constexpr double FloatWeight = 1e-5;  // sums of eight opinions over distances in single precision
    std::array<int, 3> of_kind{};         // rows with none of the eight in reach, some, all
    for (const double share : {0.05, 0.1, 0.15}) {
        Balls balls;
        localize::SpreadParameters parameters;
        parameters.reach_share = share;
        const auto before = balls.field;
        balls.field = localize::propagate_labels_knn(spans(balls.data), parameters, balls.field);
        const double reach = plain_reach(balls.data, before, parameters);
        for (std::size_t row = 0; row < 2 * PerBall; row += 3) {
            std::vector<std::pair<double, std::size_t>> seen;
            for (std::size_t other = 0; other < 2 * PerBall; ++other)
                if (const double far = distance_of(balls.data, row, other);
                    before.coverage[other] > 0 && far <= reach)
                    seen.emplace_back(far, other);
            std::sort(seen.begin(), seen.end());
            of_kind[seen.empty() ? 0 : seen.size() < 8 ? 1 : 2] += 1;
            seen.resize(std::min<std::size_t>(8, seen.size()));
            double opinion = 0, voices = 0;
            for (const auto& [far, other] : seen) {
                opinion += before.coverage[other] * before.probability[other] / (far + 1e-3 * reach);
                voices += before.coverage[other] / (far + 1e-3 * reach);
            }
            DOCTEST_CHECK(balls.field.inferred[row] == (seen.empty() ? 0 : 1));
            if (!seen.empty())
                DOCTEST_CHECK(balls.field.probability[row] ==
                              doctest::Approx(opinion / voices).epsilon(FloatWeight));
        }
    }
    for (const int rows : of_kind) DOCTEST_CHECK(rows > 10);
}

DOCTEST_TEST_CASE("without a labelled or without a seen row nothing changes") {
    Balls balls;
    for (auto& evidence : balls.field.coverage) evidence = 0;
    const auto before = balls.field.probability;
    balls.field = localize::propagate_labels_knn(spans(balls.data), {}, balls.field);
    DOCTEST_CHECK(balls.field.probability == before);
}

}  // namespace spread_test
