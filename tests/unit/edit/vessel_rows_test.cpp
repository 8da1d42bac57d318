// Vessels and the plants that grow out of them, told apart.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/edit/placement/vessel_rows.h"
#include "engine/edit/search/thing_parts.h"
#include "tests/unit/edit/box_rows.h"

namespace vessel_rows_test {

namespace {

using namespace gse;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};
constexpr std::size_t WallRows = 4000, PlantRows = 4000;

/// Rows of vessels first, then of plants, then of what stands around them.
struct Scene {
    test::BoxRows rows;

    /// Surface of revolution about x = 0.3, z = -0.2 from height 0 to `height`, turned by at most `turn`.
    Scene& vessel(double low_radius, double high_radius, double height, double turn = 2 * std::numbers::pi) {
        auto& random = rows.random;
        for (std::size_t i = 0; i < WallRows; ++i) {
            const double angle = random.uniform(0, turn), at = random.uniform(0, 1);
            const double radius =
                low_radius + at * (high_radius - low_radius) + random.uniform(-0.005, 0.005);
            rows.row({0.3 + radius * std::cos(angle), -at * height, -0.2 + radius * std::sin(angle)}, true);
        }
        return *this;
    }
    /// Leaves on stems that lean to all sides, from `low` on.
    Scene& plant(double low, double high, double reach, bool labelled = true) {
        auto& random = rows.random;
        constexpr int Stems = 14, Leaf = PlantRows / Stems;
        for (int stem = 0; stem < Stems; ++stem) {
            const double angle = random.uniform(0, 2 * std::numbers::pi), lean = random.uniform(0.1, reach);
            const double top = random.uniform(low + 0.4 * (high - low), high);
            for (int i = 0; i < Leaf; ++i) {
                const double along = random.uniform(0, 1);
                rows.row({0.3 + along * lean * std::cos(angle) + random.uniform(-0.02, 0.02),
                          -(low + along * (top - low)),
                          -0.2 + along * lean * std::sin(angle) + random.uniform(-0.02, 0.02)},
                         labelled);
            }
        }
        return *this;
    }
    std::vector<std::uint8_t> found() const {
        return edit::vessel_rows(rows.set(), rows.bits, Up, Front).vessel;
    }
};

/// Share of the rows [first, last) that are told as the vessel's.
double share(const std::vector<std::uint8_t>& found, std::size_t first, std::size_t last) {
    if (found.empty()) return 0;
    const auto count = std::count(found.begin() + static_cast<std::ptrdiff_t>(first),
                                  found.begin() + static_cast<std::ptrdiff_t>(last), std::uint8_t{1});
    return static_cast<double>(count) / static_cast<double>(last - first);
}

bool is_told_apart(const Scene& scene) {
    const auto found = scene.found();
    return share(found, 0, WallRows) > 0.95 && share(found, WallRows, scene.rows.bits.size()) < 0.08;
}

}  // namespace

DOCTEST_TEST_CASE("a vessel is told from the plant in it: wide, narrow, conical, seen from one side alone") {
    DOCTEST_CHECK(is_told_apart(Scene().vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5)));
    DOCTEST_CHECK(is_told_apart(Scene().vessel(0.12, 0.12, 0.6).plant(0.6, 1.2, 0.3)));
    DOCTEST_CHECK(is_told_apart(Scene().vessel(0.12, 0.25, 0.35).plant(0.35, 1.0, 0.4)));
    DOCTEST_CHECK(is_told_apart(Scene().vessel(0.2, 0.2, 0.4, 0.8 * std::numbers::pi).plant(0.4, 1.0, 0.5)));
}

DOCTEST_TEST_CASE("the whole vessel is told where the label holds the plant alone") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    std::fill_n(scene.rows.bits.begin(), WallRows, std::uint8_t{0});
    DOCTEST_CHECK(is_told_apart(scene));
}

DOCTEST_TEST_CASE("ground around a vessel is no part of it") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    for (int i = 0; i < 4000; ++i)
        scene.rows.row({scene.rows.random.uniform(-2, 2), scene.rows.random.uniform(0, 0.01),
                        scene.rows.random.uniform(-2, 2)},
                       false);
    DOCTEST_CHECK(is_told_apart(scene));
}

DOCTEST_TEST_CASE("nothing is told apart of a vessel alone, of a tree on its trunk and of a plant alone") {
    DOCTEST_CHECK(Scene().vessel(0.2, 0.3, 0.8).found().empty());
    DOCTEST_CHECK(Scene().vessel(0.06, 0.05, 0.9).plant(0.9, 2.2, 0.7).found().empty());
    DOCTEST_CHECK(Scene().plant(0, 1, 0.5).found().empty());
}

DOCTEST_TEST_CASE("a vase keeps its narrow neck") {
    Scene vase;
    vase.vessel(0.25, 0.3, 0.6);
    for (int i = 0; i < 1500; ++i) {
        const double angle = vase.rows.random.uniform(0, 2 * std::numbers::pi);
        vase.rows.row(
            {0.3 + 0.1 * std::cos(angle), -vase.rows.random.uniform(0.6, 1), -0.2 + 0.1 * std::sin(angle)},
            true);
    }
    DOCTEST_CHECK(vase.found().empty());
}

DOCTEST_TEST_CASE("nothing is told apart of a square box with a plant in it") {
    Scene scene;
    scene.rows.box(0.1, 0.5, 0, 0.4, -0.4, 0, 4000, true);
    DOCTEST_CHECK(scene.plant(0.4, 1.2, 0.5).found().empty());
}

DOCTEST_TEST_CASE("soil and what hangs into a pot are no part of the pot, and none of the plant") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    const std::size_t first = scene.rows.bits.size();
    for (int i = 0; i < 500; ++i)
        scene.rows.row({0.3 + scene.rows.random.uniform(-0.1, 0.1), -scene.rows.random.uniform(0.32, 0.38),
                        -0.2 + scene.rows.random.uniform(-0.1, 0.1)},
                       true);
    for (const char* noun : {"pot", "plant"}) {
        const auto label =
            edit::without_parts_beside(scene.rows.set(), scene.rows.bits, edit::nature_of(noun), Up);
        DOCTEST_CHECK(share(label, first, label.size()) < 0.02);
    }
}

DOCTEST_TEST_CASE("a thing that was pointed at is the vessel, the plant or both, as its noun says") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    const auto labelled = [&](const char* noun) {
        return edit::without_parts_beside(scene.rows.set(), scene.rows.bits, edit::nature_of(noun), Up);
    };
    const std::size_t all = scene.rows.bits.size();
    for (const char* noun : {"vase", "flower pots", "pot"}) {
        DOCTEST_CAPTURE(noun);
        DOCTEST_CHECK(share(labelled(noun), 0, WallRows) > 0.95);
        DOCTEST_CHECK(share(labelled(noun), WallRows, all) < 0.08);
    }
    for (const char* noun : {"plant", "red flowers", "cactus"}) {
        DOCTEST_CAPTURE(noun);
        DOCTEST_CHECK(share(labelled(noun), 0, WallRows) < 0.05);
        DOCTEST_CHECK(share(labelled(noun), WallRows, all) > 0.92);
    }
    for (const char* noun : {"statue", "chair"}) DOCTEST_CHECK(labelled(noun) == scene.rows.bits);
}

DOCTEST_TEST_CASE("a vessel that a box was drawn around is told from the stems in it") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    for (std::size_t row = WallRows; row < scene.rows.bits.size(); ++row)
        scene.rows.bits[row] = scene.rows.set().position()[row * 3 + 1] > -0.45F ? 1 : 0;
    const auto label =
        edit::without_parts_beside(scene.rows.set(), scene.rows.bits, edit::nature_of("pot"), Up);
    DOCTEST_CHECK(share(label, 0, WallRows) > 0.95);
    DOCTEST_CHECK(share(label, WallRows, label.size()) == 0);
}

DOCTEST_TEST_CASE("empty labels and rows that are no numbers are told nothing") {
    Scene scene;
    scene.vessel(0.2, 0.2, 0.4).plant(0.4, 1.2, 0.5);
    scene.rows.row({std::nan(""), 0, 0}, true).row({1e30, 1e30, -1e30}, true);
    DOCTEST_CHECK(share(scene.found(), 0, WallRows) > 0.95);
    std::fill(scene.rows.bits.begin(), scene.rows.bits.end(), std::uint8_t{0});
    DOCTEST_CHECK(scene.found().empty());
    DOCTEST_CHECK(edit::vessel_rows({}, {}, Up, Front).vessel.empty());
}

}  // namespace vessel_rows_test
