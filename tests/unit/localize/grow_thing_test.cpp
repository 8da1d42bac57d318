// Things grown from one point: up to what they stand on, and not along a thread.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/random.h"
#include "engine/localize/grow_thing.h"
#include "engine/math/sh.h"

namespace grow_thing_test {

namespace {

using namespace gse;
using namespace gse::localize;

constexpr double Extent = 3;    // height of a picture of the scenes
constexpr double Least = 0.85;  // IoU; where a thing stands its underside lies in the other's top
const Vec3 Up{0, 1, 0};
const Vec3 Bronze{0.45, 0.3, 0.15}, Marble{0.85, 0.85, 0.8}, Wood{0.5, 0.35, 0.2}, Green{0.2, 0.5, 0.2};

/// Scene of surfaces, with the number of the thing that each row belongs to.
struct Scene {
    GaussianData data;
    std::vector<int> thing;
    Random random{7};

    void row(const Vec3& at, const Vec3& colour, int which) {
        constexpr float size = -4.2f, solid = 3;  // log of the scale; logit
        const auto row = data.size();
        data.resize(row + 1);
        for (int axis = 0; axis < 3; ++axis) {
            const auto place = row * 3 + static_cast<std::size_t>(axis);
            data.position[place] = static_cast<float>(at[axis]);
            data.log_scale[place] = size;
            data.sh[place] = static_cast<float>(sh_from_colour(colour[axis] + random.uniform(-0.04, 0.04)));
        }
        data.rotation[row * 4] = 1, data.opacity_logit[row] = solid;
        thing.push_back(which);
    }
    /// Surface of a box from `low` to `high`.
    void box(const Vec3& low, const Vec3& high, const Vec3& colour, int which) {
        constexpr double density = 2500;  // per square unit
        const Vec3 size = high - low;
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {0.0, 1.0}) {
                const double area = size[(axis + 1) % 3] * size[(axis + 2) % 3];
                for (int i = 0; i < density * area; ++i) {
                    Vec3 share{random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
                    share[axis] = side;
                    row(low + share * size, colour, which);
                }
            }
    }
    void ball(const Vec3& centre, double radius, const Vec3& colour, int which) {
        const double area = 4 * std::numbers::pi * radius * radius;
        for (int i = 0; i < 2500 * area; ++i) {
            const double z = random.uniform(-1, 1), turn = random.uniform(0, 2 * std::numbers::pi),
                         r = std::sqrt(1 - z * z);
            row(centre + Vec3{r * std::cos(turn), z, r * std::sin(turn)} * radius, colour, which);
        }
    }
};

double iou(const Scene& scene, const std::vector<std::uint8_t>& rows, int which) {
    double both = 0, any = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const bool thing = scene.thing[row] == which, label = rows[row] != 0;
        both += thing && label ? 1 : 0, any += thing || label ? 1 : 0;
    }
    return both / std::max(1.0, any);
}

GrownThing grown(const Scene& scene, const Vec3& seed, bool ground = false) {
    return grow_thing(spans(scene.data), {seed, Up, Extent, ground});
}

GrownThing part_at(const Scene& scene, const Vec3& seed) {
    GrowRequest request{seed, Up, Extent};
    request.part = true;
    return grow_thing(spans(scene.data), request);
}

/// A figure (0) of torso and head on a plinth (1).
Scene statue(const Vec3& figure, const Vec3& plinth) {
    Scene scene;
    scene.box({-0.25, 0, -0.2}, {0.25, 0.8, 0.2}, figure, 0);
    scene.ball({0, 0.98, 0}, 0.2, figure, 0);
    scene.box({-0.5, -1, -0.5}, {0.5, 0, 0.5}, plinth, 1);
    return scene;
}

}  // namespace

DOCTEST_TEST_CASE("a statue and its plinth come apart from a click on either, whatever their colours") {
    for (const auto& plinth : {Marble, Bronze}) {
        const auto scene = statue(Bronze, plinth);
        const auto figure = grown(scene, {0, 0.5, 0.2});
        DOCTEST_CHECK(figure.from_support);
        DOCTEST_CHECK(iou(scene, figure.rows, 0) > Least);
        const auto stand = grown(scene, {0, -0.5, 0.5});
        DOCTEST_CHECK(stand.from_above);
        DOCTEST_CHECK(iou(scene, stand.rows, 1) > Least);
        const auto top = grown(scene, {0.4, 0, 0.4});  // beside the statue's feet
        DOCTEST_CHECK(iou(scene, top.rows, 1) > Least);
    }
}

DOCTEST_TEST_CASE("a thing on a table is taken without the table and without what stands beside it") {
    Scene scene;
    scene.box({-0.9, -0.1, -0.6}, {0.9, 0, 0.6}, Wood, 2);
    scene.box({-0.6, 0, -0.15}, {-0.3, 0.5, 0.15}, Marble, 0);
    scene.ball({0.4, 0.2, 0}, 0.2, Green, 1);
    DOCTEST_CHECK(iou(scene, grown(scene, {-0.45, 0.3, 0.15}).rows, 0) > Least);
    DOCTEST_CHECK(iou(scene, grown(scene, {0.4, 0.25, 0.2}).rows, 1) > Least);
}

DOCTEST_TEST_CASE("a thing that stands in nothing is taken whole, with its legs, shoulders and faint rows") {
    Scene scene;
    for (const double x : {-0.4, 0.25})
        for (const double z : {-0.2, 0.1}) scene.box({x, -0.6, z}, {x + 0.15, 0, z + 0.15}, Bronze, 0);
    scene.box({-0.45, 0, -0.25}, {0.45, 0.45, 0.25}, Bronze, 0);
    scene.ball({0.5, 0.6, 0}, 0.22, Bronze, 0);
    for (std::size_t row = 0; row < scene.data.size(); row += 9) scene.data.opacity_logit[row] = -4;
    const auto thing = grown(scene, {0, 0.2, 0.25});
    DOCTEST_CHECK_FALSE(thing.from_support);
    DOCTEST_CHECK(std::count(thing.rows.begin(), thing.rows.end(), std::uint8_t{1}) ==
                  static_cast<std::ptrdiff_t>(scene.thing.size()));
}

DOCTEST_TEST_CASE("what hangs on a thread is parted from what it hangs on") {
    Scene scene;
    scene.box({-0.5, -1, -0.5}, {0.5, -0.2, 0.5}, Marble, 0);
    scene.box({-0.02, -0.2, -0.02}, {0.02, 0.5, 0.02}, Wood, 2);
    scene.ball({0, 0.8, 0}, 0.35, Green, 1);
    const auto balloon = grown(scene, {0, 0.8, 0.35});
    DOCTEST_CHECK(balloon.from_thread);
    DOCTEST_CHECK(iou(scene, balloon.rows, 1) > 0.9);  // with a part of the thread
    DOCTEST_CHECK(iou(scene, grown(scene, {0, -0.5, 0.5}).rows, 0) > 0.9);
}

DOCTEST_TEST_CASE("a click on a ground takes the ground alone where the ground is meant") {
    Scene scene;
    scene.box({-1, -0.06, -1}, {1, 0, 1}, Green, 1);
    scene.box({-0.3, 0, -0.3}, {0.3, 0.6, 0.3}, Wood, 0);
    DOCTEST_CHECK(iou(scene, grown(scene, {0.8, 0, 0.8}, true).rows, 1) > Least);
    DOCTEST_CHECK(iou(scene, grown(scene, {0, 0.3, 0.3}).rows, 0) > Least);
}

DOCTEST_TEST_CASE("the ground is the lowest large flat, and a thing that stands in nothing has none") {
    Scene scene;  // a table with a box, on a floor below a ceiling
    scene.box({-1.2, -0.8, -1.2}, {1.2, -0.7, 1.2}, Marble, 0);
    scene.box({-0.4, -0.1, -0.4}, {0.4, 0, 0.4}, Wood, 1);
    scene.box({-0.03, -0.7, -0.03}, {0.03, -0.1, 0.03}, Wood, 1);
    scene.box({-0.15, 0, -0.15}, {0.15, 0.3, 0.15}, Green, 2);
    scene.box({-1.2, 1.2, -1.2}, {1.2, 1.25, 1.2}, Marble, 3);
    const auto seed = ground_seed(spans(scene.data), {}, 1.7, Up);
    DOCTEST_REQUIRE(seed);
    DOCTEST_CHECK(iou(scene, grow_thing(spans(scene.data), {*seed, Up, 3.4, true}).rows, 0) > Least);
    Scene ball;
    ball.ball({}, 1, Green, 0);
    DOCTEST_CHECK_FALSE(ground_seed(spans(ball.data), {}, 1, Up));
    DOCTEST_CHECK_FALSE(ground_seed(spans(Scene().data), {}, 1, Up));
}

#ifdef GSE_HAVE_OPENCV
DOCTEST_TEST_CASE("a part ends where its colour or a narrow place ends, and is told from the whole") {
    constexpr double Enough = 0.6;  // IoU; the seam runs through voxels of both
    for (const auto& colour : {Green, Bronze}) {
        Scene scene;  // a helmet at the side of a figure
        scene.box({-0.25, 0, -0.2}, {0.25, 1, 0.2}, Bronze, 0);
        scene.box({0.25, 0.47, -0.03}, {0.4, 0.53, 0.03}, Bronze, 0);
        scene.ball({0.58, 0.5, 0}, 0.2, colour, 1);
        const auto helmet = part_at(scene, {0.7, 0.5, 0.15});
        DOCTEST_CHECK(helmet.from_whole);
        DOCTEST_CHECK(iou(scene, helmet.rows, 1) > Enough);
        const auto whole = grown(scene, {0.7, 0.5, 0.15});
        DOCTEST_CHECK_FALSE(whole.from_whole);
        DOCTEST_CHECK(iou(scene, whole.rows, 1) < 0.5);
    }
    Scene scene;  // a door in a wall
    scene.box({-0.8, 0, -0.1}, {0.8, 1, 0.1}, Marble, 0);
    scene.box({-0.15, 0.2, 0.1}, {0.15, 0.8, 0.12}, Green, 1);
    DOCTEST_CHECK(iou(scene, part_at(scene, {0, 0.5, 0.12}).rows, 1) > Enough);
}

DOCTEST_TEST_CASE("what is of one colour and shape has no part") {
    Scene scene;
    scene.ball({0, 0.5, 0}, 0.5, Bronze, 0);
    const auto ball = part_at(scene, {0.3, 0.5, 0.4});
    DOCTEST_CHECK_FALSE(ball.from_whole);
    DOCTEST_CHECK(iou(scene, ball.rows, 0) > Least);
}
#endif

DOCTEST_TEST_CASE("the largest thing that stands alone is the one on the highest support") {
    const auto scene = statue(Bronze, Marble);
    const auto seed = largest_thing(spans(scene.data), {0, 0, 0}, 1.5, Up);
    DOCTEST_REQUIRE(seed.has_value());
    DOCTEST_CHECK(iou(scene, grown(scene, *seed).rows, 0) > Least);
    DOCTEST_CHECK_FALSE(largest_thing(spans(GaussianData{}), {0, 0, 0}, 1, Up).has_value());
    Scene alone;
    alone.ball({3, 0, 0}, 0.4, Green, 0);
    alone.row({3, 0, 0}, Green, 0);  // a crumb inside
    alone.row({3, 0, 0.28}, Green, 0);
    const auto middle = largest_thing(spans(alone.data), {3, 0, 0}, 0.5, Up);
    DOCTEST_REQUIRE(middle.has_value());
    DOCTEST_CHECK(std::abs(length(*middle - Vec3{3, 0, 0}) - 0.4) < 0.1);  // on the ball, which is hollow
}

DOCTEST_TEST_CASE("nothing is grown where nothing is solid, and rows without a place stay out") {
    auto scene = statue(Bronze, Marble);
    const auto nothing = grown(scene, {40, 0, 0});
    DOCTEST_CHECK(std::count(nothing.rows.begin(), nothing.rows.end(), std::uint8_t{1}) == 0);
    scene.data.position[0] = std::nanf("");
    const auto thing = grown(scene, {0, 0.5, 0.2});
    DOCTEST_CHECK(thing.rows.size() == scene.thing.size());
    DOCTEST_CHECK(thing.rows[0] == 0);
    DOCTEST_CHECK(iou(scene, thing.rows, 0) > Least);
}

}  // namespace grow_thing_test
