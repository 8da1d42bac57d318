// From where views look at what is in their middle.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/laboratory/synth/synth.h"
#include "engine/math/framing.h"
#include "engine/pipeline/run/views.h"

namespace views_test {

DOCTEST_TEST_CASE("one or two bookmarks do not take the place of the automatic views, three cameras do") {
    using namespace gse;
    Scene scene = synth::generate({}).scene;
    pipeline::EditRecipe recipe;
    recipe.request.source = "bear", recipe.request.prompt = "a blue bear";
    recipe.request.views = 8;
    const auto around = orbit_views(fit_orbit(compute_statistics(scene.gaussians), scene.info.up), 3, 64, 64);
    for (std::size_t count = 0; count <= 3; ++count) {
        const auto views = pipeline::choose_views(
            scene, pipeline::check(recipe),
            {{around.begin(), around.begin() + static_cast<std::ptrdiff_t>(count)}, {}});
        DOCTEST_CHECK(views.automatic == (count < 3));
        DOCTEST_CHECK(views.views.size() == (count < 3 ? 8u : 3u));
    }
}

DOCTEST_TEST_CASE(
    "of many cameras those farthest apart are chosen, each once, also where all stand in one place") {
    using namespace gse;
    std::vector<View> views;
    for (int i = 0; i < 12; ++i) {
        View view;
        view.name = std::to_string(i);
        const double turn = i * 0.5236;
        view.camera =
            Camera::look_at({0, 0, 0}, {std::cos(turn), 0, std::sin(turn)}, {0, -1, 0}, 0.9, 64, 64);
        views.push_back(view);
    }
    const auto names = [](const std::vector<View>& chosen) {
        std::vector<std::string> list;
        for (const auto& view : chosen) list.push_back(view.name);
        return list;
    };
    DOCTEST_CHECK(names(pipeline::farthest_views(views, 4)) == std::vector<std::string>{"0", "3", "6", "9"});
    for (auto& view : views) view.camera = views.front().camera;  // all the same
    DOCTEST_CHECK(names(pipeline::farthest_views(views, 3)) == std::vector<std::string>{"0", "1", "2"});
}

DOCTEST_TEST_CASE("azimuths and elevations of views are those of the orbit that they lie on") {
    using namespace gse;
    pipeline::Views views;
    views.orbit.centre = {1, 2, 3};
    views.orbit.radius = 4;
    views.orbit.up = {0.3, -0.9, 0.2};
    const std::vector<std::pair<double, double>> places{{0.0, 0.0}, {0.7, 0.4}, {-2.0, -0.3}, {3.0, 1.2}};
    for (const auto& [azimuth, elevation] : places) {
        auto orbit = views.orbit;
        orbit.elevation = elevation;
        views.views.push_back({});
        views.views.back().camera = orbit_camera(orbit, azimuth, 32, 32);
    }
    const auto elevations = pipeline::elevations_above(views);
    DOCTEST_REQUIRE(elevations.size() == places.size());
    for (std::size_t v = 0; v < places.size(); ++v) {
        DOCTEST_CHECK(pipeline::azimuth_of(views.views[v].camera, views.orbit) ==
                      doctest::Approx(places[v].first).epsilon(1e-9));
        DOCTEST_CHECK(elevations[v] == doctest::Approx(places[v].second).epsilon(1e-9));
    }
}

DOCTEST_TEST_CASE("a label remembers the azimuth of the camera that it was made from, wherever that stood") {
    using namespace gse;
    for (const Vec3& up : {Vec3{0, -1, 0}, Vec3{0, 0, 1}, normalized({0.2, 1, -0.3})}) {
        OrbitParameters orbit;
        orbit.up = up;
        orbit.centre = {3, -1, 2};
        for (int degrees = 0; degrees < 360; degrees += 30) {
            const auto camera = orbit_camera(orbit, degrees * pipeline::Degree, 64, 48);
            DOCTEST_CHECK(pipeline::looked_from(camera, up) == degrees);
            auto moved = camera;
            moved.translation = moved.translation + Vec3{1, 2, 3};
            DOCTEST_CHECK(pipeline::looked_from(moved, up) == degrees);
            DOCTEST_CHECK(pipeline::turned_to(moved, up) == std::to_string(degrees));
        }
        orbit.elevation = 1.4;  // radians: from above no side is looked at
        DOCTEST_CHECK(pipeline::turned_to(orbit_camera(orbit, 1, 64, 48), up).empty());
        const Bounds box{{2, -2, 1}, {4, 0, 3}};
        DOCTEST_CHECK(
            pipeline::turned_to(home_camera(orbit, box, 0.9, 64, 48), up).empty());  // nobody has chosen it
    }
}

}  // namespace views_test
