// Bounds of standing objects, whatever a label lacks or holds too much of.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/placement/upright_bounds.h"
#include "tests/unit/edit/box_rows.h"

namespace standing_test {

namespace {

using namespace gse;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};

struct Rows : test::BoxRows {
    edit::UprightBounds standing() const { return edit::standing_of(set(), bits, Up, Front); }
};

constexpr double Close = 0.04;  // of a thing 1 high: rows are drawn at random, and the outermost do not count

}  // namespace

DOCTEST_TEST_CASE(
    "a thing stands on the ground around it, also where the label lacks the end of its stem or holds some "
    "ground") {
    Rows tree;
    tree.box(-0.4, 0.4, 0.3, 1, -0.4, 0.4, 900, true).box(-0.05, 0.05, 0.1, 0.3, -0.05, 0.05, 60, true);
    const auto without = tree.standing();  // nothing says where the ground is
    DOCTEST_CHECK(-without.foot.y == doctest::Approx(0.1).epsilon(0.3));
    tree.box(-0.05, 0.05, 0, 0.1, -0.05, 0.05, 20, false).box(-2, 2, -0.01, 0.01, -2, 2, 4000, false);
    const auto found = tree.standing();
    DOCTEST_CHECK(std::abs(found.foot.y) < 0.02);
    DOCTEST_CHECK(found.height == doctest::Approx(1).epsilon(Close));
    DOCTEST_CHECK(std::abs(found.width() - 0.8) < 2 * Close);
    tree.box(-2, 2, -0.01, 0.01, -2, 2, 30,
             true);  // three in a hundred of the label: more than the bounds leave out
    const auto grown = tree.standing();
    DOCTEST_CHECK(std::abs(grown.foot.x) < Close);
    DOCTEST_CHECK(std::abs(grown.foot.z) < Close);
    DOCTEST_CHECK(grown.width() == doctest::Approx(found.width()).epsilon(0.1));
    DOCTEST_CHECK(grown.height == doctest::Approx(found.height).epsilon(Close));
}

DOCTEST_TEST_CASE(
    "a cap whose label lacks stem and lower side stands on the ground below, a statue on its pedestal") {
    Rows mushroom;
    mushroom.box(-0.4, 0.4, 0.45, 0.9, -0.4, 0.4, 900, true)
        .box(-0.38, 0.38, 0.42, 0.47, -0.38, 0.38, 200, false);
    mushroom.box(-0.1, 0.1, 0, 0.45, -0.1, 0.1, 200, false).box(-2, 2, -0.01, 0.01, -2, 2, 4000, false);
    const auto found = mushroom.standing();
    DOCTEST_CHECK(std::abs(found.foot.y) < 0.02);
    DOCTEST_CHECK(found.height == doctest::Approx(0.9).epsilon(Close));
    Rows statue;
    statue.box(-0.15, 0.15, 0.5, 1.5, -0.15, 0.15, 900, true)
        .box(-0.25, 0.25, 0, 0.5, -0.25, 0.25, 1500, false);
    statue.box(-2, 2, -0.01, 0.01, -2, 2, 4000, false);
    // Its rows reach down from its upper side.
    DOCTEST_CHECK(statue.standing().foot.y == doctest::Approx(-0.5).epsilon(0.25));
}

DOCTEST_TEST_CASE("what reaches out of a thing does not move its foot") {
    Rows cat;
    cat.box(-0.2, 0.2, 0, 0.9, -0.2, 0.2, 900, true)
        .box(0.2, 0.6, 0.5, 0.6, -0.05, 0.05, 150, true);  // its tail
    const auto found = cat.standing();
    DOCTEST_CHECK(std::abs(found.foot.x) < Close);
    DOCTEST_CHECK(std::abs(found.foot.z) < Close);
    DOCTEST_CHECK(std::abs(found.side - 0.8) < 2 * Close);  // all of it is the cat
    DOCTEST_CHECK(std::abs(found.depth - 0.4) < 2 * Close);
    double x = 0;
    const auto room = edit::room_around(GaussianSet(GaussianData(cat.data)), cat.bits, Up, Front, 0.2);
    for (const auto& centre : room.centres) x += centre.x / static_cast<double>(room.centres.size());
    DOCTEST_CHECK(std::abs(x) < 2 * Close);
}

DOCTEST_TEST_CASE("what was low may be followed by something as high as others of its width") {
    Rows car;
    car.box(-0.3, 0.3, 0, 0.6, -0.65, 0.65, 900, true);
    const auto found = car.standing();
    DOCTEST_CHECK(edit::figure_height(found) == doctest::Approx(0.75 * 1.3).epsilon(Close));
    const auto highest = [&](const edit::VoxelRegion& room) {
        double most = 0;
        for (const auto& centre : room.centres) most = std::max(most, -centre.y);
        return most + 0.5 * room.side;
    };
    const GaussianSet set{GaussianData(car.data)};
    DOCTEST_CHECK(highest(edit::room_around(set, car.bits, Up, Front, 0.2)) ==
                  doctest::Approx(1.2 * 0.75 * 1.3).epsilon(0.06));
    DOCTEST_CHECK(highest(edit::room_above(edit::standing_of(set, car.bits, Up, Front), Up, Front, 0)) ==
                  doctest::Approx(0.6).epsilon(0.06));  // what is worn sits on it
    Rows post;
    post.box(-0.1, 0.1, 0, 1, -0.1, 0.1, 500, true);
    DOCTEST_CHECK(edit::figure_height(post.standing()) == post.standing().height);
}

DOCTEST_TEST_CASE(
    "rows that cannot be seen and rows that are nowhere do not count; without others nothing stands "
    "anywhere") {
    Rows rows;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    rows.row({40, -3, 0}, true, -9).row({nan, 0, 0}, true).row({0, nan, 0}, false);
    DOCTEST_CHECK_FALSE(rows.standing().found());
    rows.box(-0.5, 0.5, 0, 1, -0.5, 0.5, 300, true);
    const auto found = rows.standing();
    DOCTEST_REQUIRE(found.found());
    DOCTEST_CHECK(found.width() < 1.01);
    DOCTEST_CHECK(std::abs(found.foot.x) < Close);
    Rows flat;  // a carpet
    flat.box(-0.5, 0.5, 0, 0, -0.5, 0.5, 300, true);
    DOCTEST_CHECK_FALSE(flat.standing().found());
}

}  // namespace standing_test
