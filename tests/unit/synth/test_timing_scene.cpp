// The scene for timing: its distribution is the stated one, and the same seed gives the same scene.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/laboratory/synth/timing_scene.h"

namespace test_timing_scene {

using namespace gse;

namespace {

constexpr std::size_t Count = 20000;

double share(const GaussianSet& set, auto&& chosen) {
    std::size_t found = 0;
    for (std::size_t row = 0; row < set.size(); ++row) found += chosen(row) ? 1 : 0;
    return static_cast<double>(found) / static_cast<double>(set.size());
}

}  // namespace

DOCTEST_TEST_CASE("timing scene: count, degree and seed") {
    const Scene a = synth::timing_scene(Count, 3), b = synth::timing_scene(Count, 3),
                c = synth::timing_scene(Count, 4);
    DOCTEST_CHECK(a.gaussians.size() == Count);
    DOCTEST_CHECK(a.gaussians.sh_degree() == 3);
    DOCTEST_CHECK(std::ranges::equal(a.gaussians.position(), b.gaussians.position()));
    DOCTEST_CHECK(std::ranges::equal(a.gaussians.sh(), b.gaussians.sh()));
    DOCTEST_CHECK_FALSE(std::ranges::equal(a.gaussians.position(), c.gaussians.position()));
    for (const std::size_t few : {1, 2, 7})
        DOCTEST_CHECK(synth::timing_scene(few, 0).gaussians.size() == few);
    const SceneStatistics statistics = compute_statistics(a.gaussians);
    DOCTEST_CHECK(statistics.nan_rows + statistics.infinite_rows + statistics.zero_quaternion_rows == 0);
}

DOCTEST_TEST_CASE("timing scene: places, sizes and opacities as stated") {
    const GaussianSet set = synth::timing_scene(Count, 0).gaussians;
    const auto position = set.position(), log_scale = set.log_scale(), rotation = set.rotation();
    const auto distance = [&](std::size_t row) {
        return std::hypot(position[row * 3], position[row * 3 + 1], position[row * 3 + 2]);
    };
    DOCTEST_CHECK(share(set, [&](std::size_t row) { return distance(row) > 10; }) ==
                  doctest::Approx(0.08).epsilon(0.05));
    DOCTEST_CHECK(share(set, [&](std::size_t row) { return distance(row) > 18; }) == 0);
    // Opaque, middling and nearly transparent ones; shares of the mixture of three normal distributions.
    const auto logit = set.opacity_logit();
    DOCTEST_CHECK(share(set, [&](std::size_t row) { return logit[row] > 4.5; }) ==
                  doctest::Approx(0.125).epsilon(0.08));
    DOCTEST_CHECK(share(set, [&](std::size_t row) { return logit[row] < -1.7; }) ==
                  doctest::Approx(0.254).epsilon(0.08));
    // Flat: the third axis is the thinnest of most.
    DOCTEST_CHECK(share(set, [&](std::size_t row) {
                      return log_scale[row * 3 + 2] < std::min(log_scale[row * 3], log_scale[row * 3 + 1]);
                  }) > 0.9);
    // The ground's splats lie in it: their third axis points up.
    DOCTEST_CHECK(share(set, [&](std::size_t row) {
                      const double x = rotation[row * 4 + 1], y = rotation[row * 4 + 2];
                      const double z = rotation[row * 4 + 3], w = rotation[row * 4];
                      return std::abs(2 * (y * z - w * x)) > 0.99;
                  }) > 0.3);
}

DOCTEST_TEST_CASE("timing cameras: a circle that looks at the middle") {
    const auto cameras = synth::timing_cameras(8, 512, 256);
    DOCTEST_REQUIRE(cameras.size() == 8);
    for (const Camera& camera : cameras) {
        const Vec3 centre = camera.centre(), middle = camera.to_camera({0, 0.6, 0});
        DOCTEST_CHECK(std::hypot(centre.x, centre.z) == doctest::Approx(6.5));
        DOCTEST_CHECK(centre.y == doctest::Approx(2.8));
        DOCTEST_CHECK(middle.x == doctest::Approx(0).epsilon(1e-9));
        DOCTEST_CHECK(middle.z > 0);
        DOCTEST_CHECK(camera.fx == doctest::Approx(256 / std::tan(std::acos(-1.0) / 6)));
    }
}

}  // namespace test_timing_scene
