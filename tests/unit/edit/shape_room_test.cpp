// Room for a new object, and the scene behind it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/edit/interfaces/clean_plate.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/target_views/ground_hole_fill.h"
#include "engine/math/sh.h"
#include "engine/math/unproject.h"
#include "tests/unit/edit/edit_scenes.h"

namespace shape_room_test {

namespace {

using namespace gse;

/// Rows on the surface of a box with its foot at height 0; up is -y.
GaussianSet post(double half_width, double height, int count = 400) {
    GaussianData data;
    data.sh_degree = 0;
    data.resize(static_cast<std::size_t>(count));
    Random random(4);
    for (std::size_t row = 0; row < data.size(); ++row) {
        data.position[row * 3] = static_cast<float>(random.uniform(-half_width, half_width));
        data.position[row * 3 + 1] = static_cast<float>(-random.uniform(0, height));
        data.position[row * 3 + 2] = static_cast<float>(random.uniform(-half_width, half_width));
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 2;
        for (int axis = 0; axis < 3; ++axis) data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = -4;
    }
    return GaussianSet(std::move(data));
}

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};

/// A floor from the horizon down; the thing has left a hole in it and stood up into the sky.
edit::CleanPlate floor_with_hole(Mask& mask) {
    constexpr int Side = 32;
    edit::CleanPlate clean_plate{Image(Side, Side, 3), Image(Side, Side, 1)};
    mask = Mask(Side, Side);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x) {
            const bool ground = y >= 16, hole = x >= 12 && x < 20 && y >= 20 && y < 26;
            mask.at(x, y) = x >= 10 && x < 22 && y >= 6 && y < 28 ? 1 : 0;
            if (!ground || hole) continue;
            clean_plate.depth.at(x, y, 0) = 10.0f - 0.2f * static_cast<float>(y);
            clean_plate.picture.at(x, y, 1) = 0.25f + 0.01f * static_cast<float>(y);
        }
    return clean_plate;
}

}  // namespace

DOCTEST_TEST_CASE("room for another thing stands where the old one stood, as wide from every side") {
    const auto set = post(0.5, 1.0);
    const std::vector<std::uint8_t> all(set.size(), 1);
    const auto room = edit::room_around(set, all, Up, Front, 0.2);
    DOCTEST_REQUIRE_FALSE(room.empty());
    double low = 1e9, high = -1e9, wide = 0;
    for (const auto& p : room.centres) {
        low = std::min(low, -p.y), high = std::max(high, -p.y);
        wide = std::max(wide, std::hypot(p.x, p.z));
    }
    DOCTEST_CHECK(low >= 0);  // not into the ground
    DOCTEST_CHECK(low < room.side);
    DOCTEST_CHECK(high == doctest::Approx(1.2).epsilon(0.05));
    DOCTEST_CHECK(wide == doctest::Approx(0.6).epsilon(0.08));
    // A pole gives way to something with a body.
    const auto tall = edit::room_around(post(0.05, 1.0), all, Up, Front, 0);
    wide = 0;
    for (const auto& p : tall.centres) wide = std::max(wide, std::hypot(p.x, p.z));
    DOCTEST_CHECK(wide > 0.3);
    DOCTEST_CHECK(edit::room_around(set, std::vector<std::uint8_t>(set.size(), 0), Up, Front, 0.2).empty());
    const auto box = edit::bounds_of(room, {});
    for (const auto& p : room.centres)
        for (int axis = 0; axis < 3; ++axis) {
            DOCTEST_CHECK(p[axis] > box.low[axis]);
            DOCTEST_CHECK(p[axis] < box.high[axis]);
        }
    const auto place = edit::bounds_of({}, set.to_data());
    DOCTEST_CHECK(place.low.x < -0.5);
    DOCTEST_CHECK(place.high.x > 0.5);
}

DOCTEST_TEST_CASE("rows too faint to be seen ask for no room") {
    auto data = post(0.5, 1.0).to_data();
    data.position[0] = 40;
    data.opacity_logit[0] = -9;
    const GaussianSet set(std::move(data));
    for (const auto& p :
         edit::room_around(set, std::vector<std::uint8_t>(set.size(), 1), Up, Front, 0.2).centres)
        DOCTEST_CHECK(std::abs(p.x) < 1);
}

DOCTEST_TEST_CASE(
    "holes in the ground are filled from around them, sky stays sky, what is there stays as it is") {
    Mask mask;
    auto clean_plate = floor_with_hole(mask);
    const auto before = clean_plate;
    DOCTEST_CHECK(edit::fill_holes(clean_plate, mask, Image(32, 32, 1, 1.0f)) == 8 * 6);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            const bool hole = x >= 12 && x < 20 && y >= 20 && y < 26;
            if (!hole) {
                DOCTEST_CHECK(clean_plate.depth.at(x, y, 0) == before.depth.at(x, y, 0));
                DOCTEST_CHECK(clean_plate.picture.at(x, y, 1) == before.picture.at(x, y, 1));
                continue;
            }
            DOCTEST_CHECK(clean_plate.filled.at(x, y) == 1);
            DOCTEST_CHECK(clean_plate.depth.at(x, y, 0) == doctest::Approx(10 - 0.2 * y).epsilon(0.1));
            DOCTEST_CHECK(clean_plate.picture.at(x, y, 1) == doctest::Approx(0.25 + 0.01 * y).epsilon(0.1));
        }
    DOCTEST_CHECK(edit::fill_holes(clean_plate, mask, Image(32, 32, 1, 1.0f)) == 0);
}

DOCTEST_TEST_CASE(
    "the rim of a hole that is seen through in part is filled, too: its colour is not that of the ground") {
    Mask mask;
    auto clean_plate = floor_with_hole(mask);
    Image alpha(32, 32, 1, 1.0f);
    for (int y = 19; y < 27; ++y)
        for (int x = 11; x < 21; ++x) {
            alpha.at(x, y, 0) = 0.6f;
            clean_plate.picture.at(x, y, 1) *= 0.6f;  // black behind the scene
        }
    DOCTEST_CHECK(edit::fill_holes(clean_plate, mask, alpha) == 10 * 8);
    for (int y = 19; y < 27; ++y)
        for (int x = 11; x < 21; ++x)
            DOCTEST_CHECK(clean_plate.picture.at(x, y, 1) == doctest::Approx(0.25 + 0.01 * y).epsilon(0.05));
}

DOCTEST_TEST_CASE(
    "the ground that a thing hid is put back as one flat layer, and nothing where a view shows what lies "
    "behind") {
    constexpr int Side = 64;
    OrbitParameters orbit;
    orbit.radius = 3;
    orbit.elevation = 0.5;
    orbit.fov_x = 0.7;
    std::vector<edit::EditView> views;
    for (int v = 0; v < 6; ++v) {
        edit::EditView view;
        view.view.camera = orbit_camera(orbit, v * 1.05, Side, Side);
        const Camera& camera = view.view.camera;
        edit::CleanPlate clean_plate{Image(Side, Side, 3, 0.5f), Image(Side, Side, 1)};
        Mask mask(Side, Side);
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x) {
                const Vec3 from = camera.centre(),
                           to = unprojected(camera, x + 0.5, y + 0.5, 1) - from;  // the ground is y = 0
                const Vec3 p = from - to * (from.y / to.y);
                const bool hole = std::hypot(p.x, p.z) < 0.4;
                mask.at(x, y) = std::hypot(p.x, p.z) < 0.6 ? 1 : 0;
                clean_plate.depth.at(x, y, 0) = hole ? 0.0f : static_cast<float>(camera.to_camera(p).z);
            }
        DOCTEST_REQUIRE(edit::fill_holes(clean_plate, mask, Image(Side, Side, 1, 1.0f)) > 0);
        view.clean_plate = std::move(clean_plate);
        views.push_back(std::move(view));
    }
    const auto rows = edit::ground_hole_fill(views, 0);
    const GaussianSet set(rows);
    DOCTEST_REQUIRE(set.size() > 50);
    const double pixel = 3.0 / views.front().view.camera.fx;
    double wide = 0;
    for (std::size_t row = 0; row < set.size(); ++row) {
        DOCTEST_CHECK(std::abs(set.position()[row * 3 + 1]) < pixel);  // on the ground
        wide = std::max(wide, std::hypot(static_cast<double>(set.position()[row * 3]),
                                         static_cast<double>(set.position()[row * 3 + 2])));
        DOCTEST_CHECK(colour_from_sh(set.sh()[row * 3]) == doctest::Approx(0.5).epsilon(0.01));
        const Vec3 normal = rotation_matrix(Quat(rows.rotation[row * 4], rows.rotation[row * 4 + 1],
                                                 rows.rotation[row * 4 + 2], rows.rotation[row * 4 + 3])) *
                            Vec3{0, 0, 1};
        DOCTEST_CHECK(std::abs(normal.y) > 0.98);
    }
    DOCTEST_CHECK(wide == doctest::Approx(0.4).epsilon(0.15));
    for (auto& view : views) {  // where all but one show what lies behind there was no ground
        if (&view == &views.front()) continue;
        std::fill(view.clean_plate.filled.data.begin(), view.clean_plate.filled.data.end(), std::uint8_t{0});
        for (auto& z : view.clean_plate.depth.data) z = 10;
    }
    DOCTEST_CHECK(edit::ground_hole_fill(views, 0).size() == 0);
    for (auto& view : views) view.clean_plate.filled = {};
    DOCTEST_CHECK(edit::ground_hole_fill(views, 0).size() == 0);
}

}  // namespace shape_room_test
