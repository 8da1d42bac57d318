// The shadow of a thing on the ground of another place.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/heal/carried_shade.h"
#include "engine/math/sh.h"
#include "engine/scene/delta.h"

namespace carried_shade_test {

namespace {

using namespace gse;

constexpr double Cell = 0.1, Reach = 1;
constexpr double Rounding =
    0.03;  // of an average over a cell and a half where the light falls by a tenth each

/// Light at a distance from the foot, that the shadow leaves.
double light(double distance) { return distance < Reach ? 0.5 + 0.5 * distance / Reach : 1; }

/// Shadow around the origin on the plane y = 0.
heal::Shadow round_shadow() {
    heal::Shadow shadow;
    shadow.cell = Cell;
    for (int x = -20; x <= 20; ++x)
        for (int z = -20; z <= 20; ++z) {
            const Vec3 at{x * Cell, 0, z * Cell};
            shadow.rows.push_back({at, Vec3(1 / light(length(at)))});
        }
    return shadow;
}

/// Rows at those places.
GaussianSet rows_at(const std::vector<Vec3>& places) {
    GaussianData data;
    data.sh_degree = 1;
    data.resize(places.size());
    for (std::size_t row = 0; row < places.size(); ++row)
        for (int k = 0; k < 3; ++k)
            data.position[row * 3 + static_cast<std::size_t>(k)] = static_cast<float>(places[row][k]);
    for (std::size_t i = 0; i < data.sh.size(); ++i) data.sh[i] = 0.01f * static_cast<float>(i % 5);
    return GaussianSet(std::move(data));
}

}  // namespace

DOCTEST_TEST_CASE("a shadow comes along with the thing, as dark as it was and no farther") {
    const Vec3 foot{5, 0, 1};
    std::vector<Vec3> places;
    for (int i = 0; i < 15; ++i) places.push_back(foot + Vec3{0.13 * i, 0, 0.02 * i});
    const auto factors = heal::carried_shade(round_shadow(), Affine::move_by(foot), rows_at(places));
    for (std::size_t i = 0; i < places.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            DOCTEST_CHECK(std::abs(factors[i][channel] - light(length(places[i] - foot))) < Rounding);
    DOCTEST_CHECK(factors.back() == Vec3(1));  // bit for bit: such rows stay
}

DOCTEST_TEST_CASE("a smaller thing has a smaller shadow") {
    const auto half = Affine::scale_about(0.5, {});
    const auto factors =
        heal::carried_shade(round_shadow(), half, rows_at({{0.2, 0, 0}, {0, 0, 0.45}, {0.7, 0, 0}}));
    DOCTEST_CHECK(std::abs(factors[0].x - light(0.4)) < Rounding);
    DOCTEST_CHECK(std::abs(factors[1].x - light(0.9)) < Rounding);
    DOCTEST_CHECK(factors[2] == Vec3(1));
}

DOCTEST_TEST_CASE("what is not on the ground of the new place keeps its light") {
    const auto factors =
        heal::carried_shade(round_shadow(), {}, rows_at({{0, 0.4, 0}, {0, -0.4, 0}, {9, 0, 9}}));
    for (const auto& factor : factors) DOCTEST_CHECK(factor == Vec3(1));
    for (const auto& factor : heal::carried_shade({}, {}, rows_at({{0, 0, 0}})))
        DOCTEST_CHECK(factor == Vec3(1));
}

DOCTEST_TEST_CASE("a lit copy has the row's colours times the light, and all else bit for bit") {
    const GaussianSet set = rows_at({{1, 2, 3}, {4, 5, 6}});
    GaussianData added;
    added.sh_degree = 1;
    heal::append_lit(set, 1, Vec3(1), added);
    heal::append_lit(set, 1, {0.5, 1, 0.25}, added);
    DOCTEST_CHECK(same_row(set.spans(), 1, spans(added), 0));
    for (std::size_t k = 0; k < 3; ++k) DOCTEST_CHECK(added.position[3 + k] == set.position()[3 + k]);
    const std::size_t stride = added.sh_stride();
    const auto colour = [&](std::size_t row, std::size_t channel) {
        return colour_from_sh(added.sh[row * stride + channel]);
    };
    constexpr double FloatRounding = 1e-6;
    DOCTEST_CHECK(std::abs(colour(1, 0) - 0.5 * colour(0, 0)) < FloatRounding);
    DOCTEST_CHECK(added.sh[stride + 1] == added.sh[1]);
    DOCTEST_CHECK(std::abs(added.sh[stride + 5] - 0.25 * added.sh[5]) < FloatRounding);
}

}  // namespace carried_shade_test
