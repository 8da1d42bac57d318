// Pedestals in a label, told from the object.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/edit/placement/pedestal_rows.h"
#include "tests/unit/edit/box_rows.h"

namespace pedestal_rows_test {

namespace {

using namespace gse;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1}, Grey{0, 0, 0};

struct Scene {
    test::BoxRows rows;

    Scene& box(double half, double low, double high, int count, bool labelled) {
        rows.box(-half, half, low, high, -half, half, count, labelled, Grey);
        return *this;
    }
    /// Labelled rows of a pedestal.
    std::vector<std::size_t> pedestal(const Vec3& front = Front) const {
        const auto rows_of = edit::pedestal_rows(rows.set(), rows.bits, Up, front);
        std::vector<std::size_t> result;
        for (std::size_t row = 0; row < rows_of.size(); ++row)
            if (rows_of[row] != 0 && rows.bits[row] != 0) result.push_back(row);
        return result;
    }
};

/// A statue 2 high on a pedestal 1.5 high, which is a surface as scans have it. The label takes in what of
/// the pedestal is above `label_foot`.
Scene statue(double label_foot) {
    constexpr double Half = 0.6, Low = -1.5;
    constexpr int Rows = 6000;  // of the statue, of the walls, of the face
    Scene scene;
    scene.box(0.3, 0, 2, Rows, true);
    auto& random = scene.rows.random;
    for (int i = 0; i < Rows; ++i) {
        const double along = random.uniform(-Half, Half), height = random.uniform(Low, 0);
        const double side = i % 2 == 0 ? Half : -Half;
        const Vec3 at = i % 4 < 2 ? Vec3{along, -height, side} : Vec3{side, -height, along};
        scene.rows.row(at, height > label_foot, 2, Grey);
    }
    for (int i = 0; i < Rows; ++i)
        scene.rows.row({random.uniform(-Half, Half), random.uniform(0, 0.01), random.uniform(-Half, Half)},
                       true, 2, Grey);
    return scene;
}

/// True where nearly all labelled rows of the pedestal are told, and hardly any of the statue.
bool is_told_apart(const Scene& scene, const std::vector<std::size_t>& rows) {
    constexpr std::size_t OfStatue = 6000, Seam = 150;
    const auto labelled = static_cast<std::size_t>(
        std::count(scene.rows.bits.begin() + OfStatue, scene.rows.bits.end(), std::uint8_t{1}));
    const auto of_statue = static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [](auto row) { return row < OfStatue; }));
    return of_statue <= Seam && 10 * (rows.size() - of_statue) >= 9 * labelled;
}

}  // namespace

DOCTEST_TEST_CASE(
    "as much of a pedestal as a label holds is left to it, and no more than a seam of the statue") {
    for (const double label_foot : {-0.05, -0.5, -0.9, -1.5}) {
        DOCTEST_CAPTURE(label_foot);
        const auto scene = statue(label_foot);
        DOCTEST_CHECK(is_told_apart(scene, scene.pedestal()));
    }
}

DOCTEST_TEST_CASE("the whole pedestal is told, also what is not labelled of it") {
    const auto scene = statue(-0.5);
    const auto rows = edit::pedestal_rows(scene.rows.set(), scene.rows.bits, Up, Front);
    DOCTEST_REQUIRE(rows.size() == 18000);
    DOCTEST_CHECK(std::count(rows.begin() + 6000, rows.begin() + 12000, std::uint8_t{1}) > 5900);
}

DOCTEST_TEST_CASE("a pedestal that stands askew to the front is found as well") {
    const Scene scene = statue(-0.5);
    for (const double degrees : {10.0, 30.0, 45.0}) {
        DOCTEST_CAPTURE(degrees);
        const double turn = degrees * std::numbers::pi / 180;
        DOCTEST_CHECK(is_told_apart(scene, scene.pedestal({std::sin(turn), 0, -std::cos(turn)})));
    }
}

DOCTEST_TEST_CASE("a round belly below a head and legs is no pedestal") {
    Scene bear;
    bear.rows.box(-0.1, 0.1, 1.1, 1.4, -0.1, 0.1, 800, true, Grey);  // its head
    for (int i = 0; i < 8000; ++i) {                                 // an ellipsoid
        const Vec3 at{bear.rows.random.normal(), bear.rows.random.normal(), bear.rows.random.normal()};
        const Vec3 unit = at * (1 / length(at));
        bear.rows.row({0.4 * unit.x, -0.65 + 0.45 * unit.y, 0.4 * unit.z}, true, 2, Grey);
    }
    for (const double x : {-0.2, 0.2}) bear.rows.box(x - 0.08, x + 0.08, 0, 0.4, -0.1, 0.1, 600, true, Grey);
    bear.box(2, -0.02, 0, 3000, false);
    DOCTEST_CHECK(bear.pedestal().empty());
}

DOCTEST_TEST_CASE("a label of the upper half alone does not make a pedestal of a wider lower half") {
    Scene robed;
    robed.box(0.3, 1, 2, 4000, true).box(0.7, 0, 1, 6000, false);
    DOCTEST_CHECK(robed.pedestal().empty());
}

DOCTEST_TEST_CASE("a seat on legs whose feet were not labelled keeps its legs") {
    Scene chair;
    chair.box(0.6, 0.5, 0.7, 3000, true);
    for (const double x : {-0.55, 0.55})
        for (const double z : {-0.55, 0.55}) {
            chair.rows.box(x - 0.05, x + 0.05, 0.2, 0.5, z - 0.05, z + 0.05, 300, true, Grey);
            chair.rows.box(x - 0.05, x + 0.05, -0.1, 0.2, z - 0.05, z + 0.05, 300, false, Grey);
        }
    chair.rows.box(-0.6, 0.6, 0.7, 1.6, 0.5, 0.6, 2000, true, Grey);  // its back
    DOCTEST_CHECK(chair.pedestal().empty());
}

DOCTEST_TEST_CASE("a thing on open ground, an empty label and rows that are no numbers lose nothing") {
    Scene bear;
    bear.box(0.3, 0.02, 1, 2000, true).box(2, -0.02, 0.02, 3000, false);
    DOCTEST_CHECK(bear.pedestal().empty());
    Scene nothing;
    nothing.box(1, 0, 1, 500, false);
    DOCTEST_CHECK(nothing.pedestal().empty());
    DOCTEST_CHECK(edit::pedestal_rows({}, {}, Up, Front).empty());
}

}  // namespace pedestal_rows_test
