// The near plane that follows scene and camera, and the box that is framed.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include "engine/scene/depth_range.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/scene/framing.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/scene.h"

namespace depth_range_test {

using namespace gse;

namespace {

/// A ball of splats of this radius around a centre.
GaussianData ball(std::size_t count, const Vec3& centre, double radius, std::uint64_t seed = 5) {
    Random random(seed);
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
        const Vec3 at = centre + normalized({random.normal(), random.normal(), random.normal()}) * radius *
                                     std::cbrt(random.uniform());
        for (int axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(at[axis]);
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] =
                static_cast<float>(std::log(radius * 0.02));
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 2;
    }
    return data;
}

Camera looking(const Vec3& eye, const Vec3& target) {
    return Camera::look_at(eye, target, {0, -1, 0}, 0.9, 300, 200);
}

void place(GaussianData& data, std::size_t row, const Vec3& at) {
    for (int axis = 0; axis < 3; ++axis)
        data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(at[axis]);
}

}  // namespace

DOCTEST_TEST_CASE("the near plane grows with the scene and lies before it") {
    const double at_one = fitted_near_plane(spans(ball(3000, {}, 1)), looking({0, 0, -3}, {}));
    DOCTEST_CHECK(at_one > 0.1);
    DOCTEST_CHECK(at_one < 0.4);
    for (const double scale : {1e-6, 1e-3, 1e-2, 1e3, 1e4, 1e8})
        DOCTEST_CHECK(fitted_near_plane(spans(ball(3000, {}, scale)), looking({0, 0, -3 * scale}, {})) ==
                      doctest::Approx(at_one * scale).epsilon(1e-3));
}

DOCTEST_TEST_CASE("the near plane follows the camera to a small thing in a large scene") {
    GaussianData data = ball(6000, {}, 100);
    const GaussianData thing = ball(6000, {5, 5, 5}, 0.05, 6);
    std::copy_n(thing.position.begin(), 3000 * 3, data.position.begin());
    const double near = fitted_near_plane(spans(data), looking({5, 5, 4.8}, {5, 5, 5}));
    DOCTEST_CHECK(near > 0.005);
    DOCTEST_CHECK(near < 0.1);
}

DOCTEST_TEST_CASE(
    "floaters before the camera, splats that are not seen and numbers that are none do not count") {
    GaussianData data = ball(1000, {}, 1);
    const Camera camera = looking({0, 0, -3}, {});
    const double clean = fitted_near_plane(spans(data), camera);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    infinity = std::numeric_limits<float>::infinity();
    for (std::size_t row = 0; row < 10; ++row) place(data, row * 100, {0, 0, -2.99});
    for (std::size_t row = 1; row < 300; ++row) {
        place(data, row, {0, 0, -2.9});
        data.opacity_logit[row] = row % 2 == 0 ? -9.0f : nan;
    }
    place(data, 301, {nan, 0, 0});
    place(data, 302, {0, infinity, 0});
    DOCTEST_CHECK(fitted_near_plane(spans(data), camera) == doctest::Approx(clean).epsilon(0.1));
}

DOCTEST_TEST_CASE("there is a near plane for little and for nothing") {
    GaussianData one = ball(1, {0, 0, 2}, 0);
    DOCTEST_CHECK(fitted_near_plane(spans(one), looking({0, 0, 0}, {0, 0, 1})) == doctest::Approx(0.2));
    DOCTEST_CHECK(fitted_near_plane(spans(one), looking({0, 0, 4}, {0, 0, 5})) == 0);  // behind
    DOCTEST_CHECK(fitted_near_plane(spans(one), looking({0, 0, 0}, {3, 0, 1})) > 0);   // beside the picture
    DOCTEST_CHECK(fitted_near_plane(spans(GaussianData{}), looking({0, 0, 0}, {0, 0, 1})) == 0);
}

DOCTEST_TEST_CASE("small scenes can be selected in") {
    for (const double scale : {1e-3, 1.0, 1e4}) {
        const GaussianSet set(ball(500, {}, scale));
        const Camera camera = looking({0, 0, -4 * scale}, {});
        ScreenArea all;
        all.polygon = {{0, 0}, {300, 0}, {300, 200}, {0, 200}};
        const auto rows = rows_in_area(set, camera, all);
        DOCTEST_CHECK(std::count(rows.begin(), rows.end(), 1) == 500);
    }
}

DOCTEST_TEST_CASE("what is framed holds the scene and its splats but no floaters") {
    GaussianData data = ball(2000, {3, 0, 0}, 1);
    for (std::size_t row = 0; row < 15; ++row) place(data, row, {3, -300, 40});
    const Bounds bounds = framing_bounds(GaussianSet(data));
    DOCTEST_CHECK(bounds.low.x < 2.1);
    DOCTEST_CHECK(bounds.low.x > 1.7);
    DOCTEST_CHECK(bounds.high.x > 3.9);
    DOCTEST_CHECK(bounds.low.y > -1.5);
    DOCTEST_CHECK(bounds.high.z < 1.5);
}

DOCTEST_TEST_CASE("thin ends of a thing are framed") {
    GaussianData data = ball(2000, {}, 1);
    for (std::size_t row = 0; row < 12; ++row)
        place(data, row, {0, -1 - 0.02 * static_cast<double>(row), 0});  // an ear
    DOCTEST_CHECK(framing_bounds(GaussianSet(data)).low.y < -1.15);
}

DOCTEST_TEST_CASE("a label is framed by its rows alone") {
    GaussianData data = ball(2000, {}, 1);
    std::vector<std::uint8_t> bits(2000);
    for (std::size_t row = 0; row < 100; ++row) {
        bits[row] = 1;
        place(data, row, Vec3{0.5, 0.5, 0.5} + Vec3{0.1, 0, 0} * (static_cast<double>(row) / 99));
    }
    const GaussianSet set(data);
    const Bounds bounds = framing_bounds(set, bits);
    DOCTEST_CHECK(length(bounds.centre() - Vec3{0.55, 0.5, 0.5}) < 0.01);
    DOCTEST_CHECK(bounds.radius() < 0.15);
    DOCTEST_CHECK(framing_bounds(set, std::vector<std::uint8_t>(2000)).radius() == 0);
}

DOCTEST_TEST_CASE("a splat alone is framed by its own size") {
    const GaussianData data = ball(1, {0, 0, 2}, 0.5);
    const SceneStatistics s = compute_statistics(GaussianSet(data));
    DOCTEST_CHECK(framing_bounds(GaussianSet(data)).radius() == doctest::Approx(0.02 * std::sqrt(3.0)));
    DOCTEST_CHECK(fit_orbit(s, {0, -1, 0}).radius < 0.2);
}

}  // namespace depth_range_test
