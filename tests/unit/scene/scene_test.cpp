// Labels, statistics, fitted orbits and the structure of arrays.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include "engine/scene/scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/scene/morton.h"

namespace scene_test {

using namespace gse;

namespace {

constexpr float Nan = std::numeric_limits<float>::quiet_NaN();
constexpr float Infinity = std::numeric_limits<float>::infinity();

/// Splats in a box of half sides (1, 2, 3) around `centre`, all visible and small.
GaussianData box_of_splats(std::size_t count, const Vec3& centre, std::uint64_t seed) {
    Random random(seed);
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
        for (int axis = 0; axis < 3; ++axis)
            data.position[row * 3 + static_cast<std::size_t>(axis)] =
                static_cast<float>(centre[axis] + random.uniform(-1, 1) * (axis + 1));
        for (std::size_t axis = 0; axis < 3; ++axis) data.log_scale[row * 3 + axis] = -4;
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 2;
    }
    return data;
}

}  // namespace

DOCTEST_TEST_CASE("a label's bits follow its threshold, its weights never change") {
    const std::vector<float> weight = {0, 0.2f, 0.5f, 0.500001f, 1, Nan};
    const Label label = make_label("hat", weight, 0.5f);
    DOCTEST_CHECK(label.name == "hat");
    DOCTEST_CHECK(*label.bits == std::vector<std::uint8_t>{0, 0, 0, 1, 1, 0});
    DOCTEST_CHECK(label.weight->at(1) == 0.2f);
    DOCTEST_CHECK(*make_label("hat", weight, 0.1f).bits == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 0});
}

DOCTEST_TEST_CASE("statistics count each oddity once per row") {
    GaussianData data = box_of_splats(200, {5, 6, 7}, 1);
    data.position[3 * 0] = Nan;
    data.sh[3 * 1 + 2] = Nan;
    data.opacity_logit[2] = Nan;
    data.position[3 * 3 + 1] = -Infinity;
    data.log_scale[3 * 4] = Infinity;
    data.log_scale[3 * 5] = -Infinity;  // a flat axis: legal
    data.opacity_logit[6] = Infinity;   // opaque: legal
    data.opacity_logit[7] = -Infinity;  // invisible: legal
    data.opacity_logit[8] = -6;         // 0.0025 < 1/255
    data.rotation[4 * 9] = 0;
    data.log_scale[3 * 10 + 2] = 5;  // 148 units
    const SceneStatistics s = compute_statistics(GaussianSet(data));
    DOCTEST_CHECK(s.count == 200);
    DOCTEST_CHECK(s.nan_rows == 3);
    DOCTEST_CHECK(s.infinite_rows == 2);
    DOCTEST_CHECK(s.zero_quaternion_rows == 1);
    DOCTEST_CHECK(s.invisible_rows == 2);
    DOCTEST_CHECK(s.giant_rows == 2);  // row 10 and the infinite row 4
    DOCTEST_CHECK(drop_unusable(GaussianSet(data)).size() == 195);
}

DOCTEST_TEST_CASE("what cannot be drawn is hidden, and everything else stays as it is") {
    GaussianData data = box_of_splats(100, {5, 6, 7}, 3);
    data.position[3 * 0] = Nan;
    data.position[3 * 1] = 1e30f;
    data.rotation[4 * 2 + 1] = -1e30f;
    data.sh[data.sh_stride() * 3] = 1e10f;
    data.log_scale[3 * 4] = 1e30f;
    data.opacity_logit[5] = Nan;
    data.log_scale[3 * 6] = -1e30f;  // flat: legal
    data.opacity_logit[7] = 1e30f;   // opaque: legal
    const GaussianSet set(data);
    const SceneStatistics statistics = compute_statistics(set);
    DOCTEST_CHECK(statistics.nan_rows == 2);
    DOCTEST_CHECK(statistics.infinite_rows == 4);
    DOCTEST_CHECK(statistics.visible_rows == 94);
    DOCTEST_CHECK(statistics.bounds_high.x < 10);
    const GaussianSet drawn = drawable(set);
    DOCTEST_REQUIRE(drawn.size() == set.size());
    DOCTEST_CHECK(compute_statistics(drawn).nan_rows + compute_statistics(drawn).infinite_rows == 0);
    for (std::size_t row = 0; row < 6; ++row) DOCTEST_CHECK(drawn.opacity_logit()[row] < -50);
    for (std::size_t i = 3 * 6; i < 300; ++i) DOCTEST_CHECK(drawn.position()[i] == set.position()[i]);
    for (std::size_t row = 6; row < 100; ++row)
        DOCTEST_CHECK(drawn.opacity_logit()[row] == set.opacity_logit()[row]);
    const GaussianSet clean(box_of_splats(100, {5, 6, 7}, 3));
    DOCTEST_CHECK(drawable(clean).shares_all_with(clean));
}

DOCTEST_TEST_CASE("robust bounds ignore a few floaters, plain bounds do not") {
    GaussianData data = box_of_splats(1000, {5, 6, 7}, 2);
    for (std::size_t row = 0; row < 5; ++row) data.position[row * 3] = 1e6f;
    const SceneStatistics s = compute_statistics(GaussianSet(data));
    DOCTEST_CHECK(s.bounds_high.x == 1e6);
    DOCTEST_CHECK(s.robust_high.x < 6.01);
    DOCTEST_CHECK(s.robust_high.x > 5.8);
    DOCTEST_CHECK(s.robust_low.z < 4.5);
    DOCTEST_CHECK(s.mean_opacity == doctest::Approx(1 / (1 + std::exp(-2.0))));
}

DOCTEST_TEST_CASE("invisible splats do not stretch the robust bounds") {
    GaussianData data = box_of_splats(1000, {0, 0, 0}, 3);
    for (std::size_t row = 0; row < 400; ++row) {
        data.position[row * 3] = 500;
        data.opacity_logit[row] = -20;
    }
    DOCTEST_CHECK(compute_statistics(GaussianSet(data)).robust_high.x < 1.01);
}

DOCTEST_TEST_CASE("statistics of nothing are zero, and an orbit can still be fitted") {
    const SceneStatistics s = compute_statistics(GaussianSet());
    DOCTEST_CHECK(s.count == 0);
    DOCTEST_CHECK(s.bounds_low == Vec3{});
    DOCTEST_CHECK(fit_orbit(s, {0, -1, 0}).radius > 0);
    const SceneStatistics one = compute_statistics(GaussianSet(box_of_splats(1, {4, 4, 4}, 1)));
    DOCTEST_CHECK(fit_orbit(one, {0, -1, 0}).radius > 0);
}

DOCTEST_TEST_CASE("every orbit view sees the whole robust box, upright") {
    const SceneStatistics s = compute_statistics(GaussianSet(box_of_splats(2000, {5, -6, 7}, 4)));
    for (const Vec3& up : {Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}) {
        const OrbitParameters orbit = fit_orbit(s, up);
        const auto views = orbit_views(orbit, 12, 200, 200);
        DOCTEST_REQUIRE(views.size() == 12);
        for (const View& view : views) {
            DOCTEST_CHECK(!view.distorted);
            for (int corner = 0; corner < 8; ++corner) {
                const Vec3 point = {(corner & 1) != 0 ? s.robust_low.x : s.robust_high.x,
                                    (corner & 2) != 0 ? s.robust_low.y : s.robust_high.y,
                                    (corner & 4) != 0 ? s.robust_low.z : s.robust_high.z};
                const Vec3 p = view.camera.to_camera(point);
                DOCTEST_CHECK(p.z > 0);
                const double x = view.camera.fx * p.x / p.z + view.camera.cx;
                const double y = view.camera.fy * p.y / p.z + view.camera.cy;
                DOCTEST_CHECK(x >= 0);
                DOCTEST_CHECK(x <= 200);
                DOCTEST_CHECK(y >= 0);
                DOCTEST_CHECK(y <= 200);
            }
            DOCTEST_CHECK(view.camera.to_camera(orbit.centre + up).y < 0);
        }
        // Two elevations: neighbours look down differently steeply.
        DOCTEST_CHECK(std::abs(dot(views[0].camera.forward(), up) - dot(views[1].camera.forward(), up)) >
                      0.1);
        DOCTEST_CHECK(length(views[0].camera.centre() - views[6].camera.centre()) > orbit.radius);
    }
}

DOCTEST_TEST_CASE("filtering keeps rows in order and bit for bit; copies share their arrays") {
    GaussianData data = box_of_splats(50, {0, 0, 0}, 5);
    data.sh_degree = 2;
    data.sh.resize(data.size() * data.sh_stride());
    for (std::size_t i = 0; i < data.sh.size(); ++i) data.sh[i] = static_cast<float>(i);
    const GaussianSet set(data);
    const GaussianSet copy = set;
    DOCTEST_CHECK(copy.position().data() == set.position().data());
    std::vector<unsigned char> keep(50);
    for (std::size_t row = 0; row < 50; row += 3) keep[row] = 1;
    const GaussianSet kept = set.filtered(keep);
    DOCTEST_REQUIRE(kept.size() == 17);
    for (std::size_t row = 0; row < 17; ++row) {
        DOCTEST_CHECK(kept.position()[row * 3 + 1] == set.position()[row * 9 + 1]);
        DOCTEST_CHECK(kept.sh()[row * 27 + 26] == set.sh()[row * 81 + 26]);
    }
    DOCTEST_CHECK(set.byte_size() == 50 * (3 + 3 + 4 + 1 + 27) * sizeof(float));
    GaussianData joined = set.to_data();
    joined.append_row(data, 7);
    DOCTEST_CHECK(joined.size() == 51);
    DOCTEST_CHECK(joined.sh.back() == data.sh[7 * 27 + 26]);
}

DOCTEST_TEST_CASE("the Morton order has every point once, cell by cell, broken points among the first") {
    std::vector<float> position;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z)
                position.insert(position.end(),
                                {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    position[5 * 3] = std::numeric_limits<float>::quiet_NaN();
    const auto order = gse::morton_order(position);
    std::vector<std::uint32_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < sorted.size(); ++i) DOCTEST_CHECK(sorted[i] == i);
    DOCTEST_CHECK((order[0] == 5 || order[1] == 5));
    const auto octant = [&](std::size_t i) {
        int code = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            code |= (position[order[i] * 3 + axis] >= 2 ? 1 : 0) << axis;
        return code;
    };
    for (std::size_t i = 8; i < order.size(); ++i) DOCTEST_CHECK(octant(i) == static_cast<int>(i / 8));
    DOCTEST_CHECK(gse::morton_order({}).empty());
}

}  // namespace scene_test
