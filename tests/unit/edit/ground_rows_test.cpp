// Ground in a label, told from the object.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <vector>

#include "engine/edit/placement/ground_rows.h"
#include "engine/edit/placement/thing_bounds.h"
#include "engine/scene/framing.h"
#include "tests/unit/edit/box_rows.h"

namespace ground_rows_test {

namespace {

using namespace gse;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};

/// Things 1 high and 0.6 wide, and grounds.
struct Scene {
    test::BoxRows rows;

    Scene& box(double half, double low, double high, const Vec3& colour, int count, bool labelled) {
        rows.box(-half, half, low, high, -half, half, count, labelled, colour);
        return *this;
    }
    std::vector<std::size_t> ground() const { return edit::ground_rows(rows.set(), rows.bits, Up, Front); }
};

const Vec3 Red{1, -1, -1}, Green{-1, 0.5, -1};

}  // namespace

DOCTEST_TEST_CASE("ground that a label holds below a thing is told from the thing by height and colour") {
    Scene bear;
    bear.box(0.3, 0.02, 1, Red, 2000, true)
        .box(0.3, -0.005, 0.005, Green, 60, true)
        .box(2, -0.005, 0.005, Green, 3000, false);
    const auto ground = bear.ground();
    DOCTEST_REQUIRE(ground.size() == 60);
    DOCTEST_CHECK(ground.front() == 2000);
    DOCTEST_CHECK(ground.back() == 2059);
}

DOCTEST_TEST_CASE("a thing keeps rows of its own colour, and green ones that are high") {
    Scene frog;  // as green as the grass it sits on
    frog.box(0.3, 0, 1, Green, 2000, true).box(2, -0.005, 0.005, Green, 3000, false);
    DOCTEST_CHECK(frog.ground().empty());
    Scene tree;
    tree.box(0.3, 0, 0.6, Red, 1000, true)
        .box(0.3, 0.6, 1, Green, 1000, true)
        .box(2, -0.005, 0.005, Green, 3000, false);
    DOCTEST_CHECK(tree.ground().empty());
}

DOCTEST_TEST_CASE(
    "a ground that is a label of its own, a thing without ground and an empty label lose nothing") {
    Scene lawn;
    lawn.box(2, -0.005, 0.005, Green, 3000, true)
        .box(0.3, 0.02, 1, Red, 500, false)
        .box(3, -0.005, 0.005, Green, 200, false);
    DOCTEST_CHECK(lawn.ground().empty());
    Scene floating;
    floating.box(0.3, 0, 1, Red, 2000, true).box(0.3, -0.005, 0.005, Green, 60, true);
    DOCTEST_CHECK(floating.ground().empty());
    Scene potted;  // what is not labelled lies within it: no ground
    potted.box(0.3, 0, 1, Red, 2000, true)
        .box(0.3, -0.005, 0.005, Green, 60, true)
        .box(0.2, -0.005, 0.005, Green, 300, false);
    DOCTEST_CHECK(potted.ground().empty());
    Scene nothing;
    nothing.box(2, -0.005, 0.005, Green, 300, false);
    DOCTEST_CHECK(nothing.ground().empty());
}

DOCTEST_TEST_CASE(
    "of what is labelled around a ground the lowest layer is the ground, however it slopes; what is no wider "
    "than high stays whole") {
    test::BoxRows lawn;
    lawn.box(-2, 2, 0, 0.02, -2, 2, 4000, true, Green)
        .box(-0.4, 0.4, 0.3, 1.2, -0.4, 0.4, 500, true, Red)
        .box(-2, 2, 0, 0.02, -2, 2, 100, false, Green);
    const auto flat = edit::lowest_layer(lawn.set(), lawn.bits, Up);
    for (std::size_t row = 0; row < flat.size(); ++row) DOCTEST_CHECK((flat[row] != 0) == (row < 4000));
    for (std::size_t row = 0; row < flat.size(); ++row)
        lawn.data.position[row * 3 + 1] -= 0.15f * lawn.data.position[row * 3];
    DOCTEST_CHECK(edit::lowest_layer(lawn.set(), lawn.bits, Up) == flat);
    test::BoxRows tower;
    tower.box(-0.5, 0.5, 0, 3, -0.5, 0.5, 1000, true, Red);
    DOCTEST_CHECK(edit::lowest_layer(tower.set(), tower.bits, Up) == tower.bits);
    test::BoxRows nothing;
    nothing.box(-1, 1, 0, 1, -1, 1, 10, false);
    DOCTEST_CHECK(edit::lowest_layer(nothing.set(), nothing.bits, Up) == nothing.bits);
}

DOCTEST_TEST_CASE(
    "a camera's home frames what stands on the ground; a scene without either is framed whole") {
    constexpr double Room = 0.25;  // world units around the thing: its splats and the trimming
    test::BoxRows lawn;
    lawn.box(-4, 4, 0, 0.02, -4, 4, 8000, false, Green).box(1, 1.8, 0.05, 1.2, -0.4, 0.4, 2000, false, Red);
    const Bounds thing = edit::thing_bounds(lawn.set(), Up);
    DOCTEST_CHECK(thing.low.x > 1 - Room);
    DOCTEST_CHECK(thing.high.x < 1.8 + Room);
    DOCTEST_CHECK(thing.high.z < 0.4 + Room);
    const auto same = [](const test::BoxRows& rows) {
        const Bounds whole = framing_bounds(rows.set()), found = edit::thing_bounds(rows.set(), Up);
        return length(whole.low - found.low) == 0 && length(whole.high - found.high) == 0;
    };
    test::BoxRows alone, flat, nothing;
    alone.box(-0.5, 0.5, 0, 3, -0.5, 0.5, 1000, false, Red);
    flat.box(-2, 2, 0, 0.02, -2, 2, 3000, false, Green);
    nothing.box(-1, 1, 0, 1, -1, 1, 0, false);
    DOCTEST_CHECK(same(alone));
    DOCTEST_CHECK(same(flat));
    DOCTEST_CHECK(same(nothing));
}

}  // namespace ground_rows_test
