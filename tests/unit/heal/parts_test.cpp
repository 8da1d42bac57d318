// The steps of healing one by one: distances, membranes, patches.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/heal/distance.h"
#include "engine/heal/hole.h"
#include "engine/heal/patch_fill.h"
#include "engine/heal/smooth_fill.h"

namespace heal_parts_test {

using namespace gse;
using namespace gse::heal;

DOCTEST_TEST_CASE("distances are those to the nearest cell") {
    Random random(3);
    for (int round = 0; round < 20; ++round) {
        BitGrid bits(1 + static_cast<int>(random.below(20)), 1 + static_cast<int>(random.below(20)), 0);
        for (auto& bit : bits.cells) bit = random.below(12) == 0 ? 1 : 0;
        const auto distance = distance_to(bits);
        each_cell(bits, [&](int x, int y) {
            double least = FarAway;
            each_cell(bits, [&](int a, int b) {
                if (bits.at(a, b) != 0) least = std::min(least, std::hypot(a - x, b - y));
            });
            DOCTEST_CHECK(distance.at(x, y) == doctest::Approx(least));
        });
    }
}

DOCTEST_TEST_CASE("a membrane goes on with a plane, and stays between its rim's values") {
    constexpr double Tolerance = 1e-3;  // of what is left after the sweeps, for values of about ten
    Grid<double> values(24, 20, 0);
    BitGrid fill(24, 20, 0), fixed(24, 20, 0);
    each_cell(values, [&](int x, int y) {
        const bool inside = std::hypot(x - 12, y - 10) < 7;
        (inside ? fill : fixed).at(x, y) = 1;
        if (!inside) values.at(x, y) = 0.5 * x - 0.25 * y;
    });
    fill_membrane(values, fill, fixed);
    each_cell(values, [&](int x, int y) {
        DOCTEST_CHECK(values.at(x, y) == doctest::Approx(0.5 * x - 0.25 * y).epsilon(Tolerance));
    });
}

DOCTEST_TEST_CASE("heights go on with their curvature") {
    Chart chart;
    chart.cell = 0.1, chart.tolerance = 0.05;
    chart.height = Grid<double>(40, 40, 0);
    chart.seen = BitGrid(40, 40, 1);
    BitGrid hole(40, 40, 0);
    const auto bowl = [](int x, int y) { return 0.002 * ((x - 20) * (x - 20) + 0.5 * (y - 18) * (y - 18)); };
    each_cell(hole, [&](int x, int y) {
        chart.height.at(x, y) = bowl(x, y);
        if (std::hypot(x - 20, y - 20) >= 8) return;
        hole.at(x, y) = 1;
        chart.seen.at(x, y) = 0;
        chart.height.at(x, y) = -5;
    });
    fill_heights(chart, hole);
    constexpr double Tolerance = 0.006;  // a tenth of the depth of the bowl there
    each_cell(hole,
              [&](int x, int y) { DOCTEST_CHECK(std::abs(chart.height.at(x, y) - bowl(x, y)) < Tolerance); });
}

DOCTEST_TEST_CASE("a periodic texture is completed without an error") {
    for (const int period : {4, 7}) {
        Grid<Vec3> colour(48, 44);
        BitGrid known(48, 44, 1), hole(48, 44, 0);
        Grid<Vec3> truth = colour;
        each_cell(hole, [&](int x, int y) {
            const bool odd = (x / period + y / period) % 2 != 0;
            truth.at(x, y) = odd ? Vec3{0.9, 0.8, 0.7} : Vec3{0.2, 0.3, 0.3};
            if (std::abs(x - 24) < 7 && std::abs(y - 22) < 6) hole.at(x, y) = 1, known.at(x, y) = 0;
            else colour.at(x, y) = truth.at(x, y);
        });
        const auto fill = fill_by_patches(colour, known, hole, BitGrid(48, 44, 0), 5);
        DOCTEST_REQUIRE(fill.found);
        std::size_t wrong = 0, cells = 0;
        each_cell(hole, [&](int x, int y) {
            if (hole.at(x, y) == 0) return;
            const Shift shift = fill.shift.at(x, y);
            DOCTEST_CHECK(known.at(x + shift.x, y + shift.y) == 1);
            ++cells;
            if (length(fill.colour.at(x, y) - truth.at(x, y)) > 1e-6) ++wrong;
        });
        constexpr double MostWrong = 0.02;  // of the cells
        DOCTEST_CHECK(static_cast<double>(wrong) <= MostWrong * static_cast<double>(cells));
    }
}

DOCTEST_TEST_CASE("with nothing to copy from, the colours of the rim are mixed") {
    Grid<Vec3> colour(6, 6, Vec3{0.5, 0.4, 0.3});
    BitGrid known(6, 6, 0), hole(6, 6, 1);
    known.at(0, 0) = 1, hole.at(0, 0) = 0;
    const auto fill = fill_by_patches(colour, known, hole, BitGrid(6, 6, 0), 1);
    DOCTEST_CHECK(!fill.found);
    DOCTEST_CHECK(length(fill.colour.at(3, 3) - Vec3{0.5, 0.4, 0.3}) < 1e-6);
}

DOCTEST_TEST_CASE("groups touch by sides and corners") {
    BitGrid bits(5, 5, 0);
    bits.at(0, 0) = bits.at(1, 1) = bits.at(4, 4) = 1;
    std::vector<std::size_t> sizes;
    const auto groups = groups_of(bits, sizes);
    DOCTEST_CHECK(sizes == std::vector<std::size_t>{0, 2, 1});
    DOCTEST_CHECK(groups.at(0, 0) == groups.at(1, 1));
}

}  // namespace heal_parts_test
