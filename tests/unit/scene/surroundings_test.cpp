// Haze, sky and floaters far around a scene do not decide its frame; open country and second things do.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/scene/framing.h"
#include "engine/scene/layout/surroundings.h"
#include "engine/scene/scene.h"

namespace surroundings_test {

namespace {

using namespace gse;

constexpr double SameFrame = 1.05;  // the outermost splats of the scene may go with the haze

float logit(double opacity) { return static_cast<float>(std::log(opacity / (1 - opacity))); }

void add(GaussianData& data, const Vec3& at, double opacity, double size) {
    const std::size_t row = data.size();
    data.resize(row + 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        data.position[row * 3 + axis] = static_cast<float>(at[static_cast<int>(axis)]);
        data.log_scale[row * 3 + axis] = static_cast<float>(std::log(size));
    }
    data.rotation[row * 4] = 1;
    data.opacity_logit[row] = logit(opacity);
}

Vec3 in_ball(Random& random) {
    for (;;) {
        const Vec3 at{2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
        if (length(at) <= 1) return at;
    }
}

/// A ball of radius 1 on a round ground of radius 3.
GaussianData thing_on_ground(Random& random) {
    GaussianData data;
    for (int i = 0; i < 2000; ++i) add(data, normalized(in_ball(random)), 0.9, 0.05);
    while (data.size() < 5000) {
        const Vec3 at = in_ball(random) * 3.0;
        add(data, {at.x, 1, at.z}, 0.9, 0.05);
    }
    return data;
}

double frame(const GaussianData& data) {
    const auto statistics = compute_statistics(GaussianSet(data));
    return length(statistics.robust_high - statistics.robust_low);
}

}  // namespace

DOCTEST_TEST_CASE("faint haze, few or many splats, near or far, leaves the frame as it was") {
    Random random(1);
    const GaussianData scene = thing_on_ground(random);
    const double bare = frame(scene), box = framing_bounds(GaussianSet(scene)).radius();
    for (const int count : {300, 500, 6000})
        for (const double reach : {15.0, 40.0, 90.0}) {
            GaussianData hazy = scene;
            for (int i = 0; i < count; ++i) add(hazy, in_ball(random) * reach, 0.02, 0.14);
            DOCTEST_CAPTURE(count);
            DOCTEST_CAPTURE(reach);
            DOCTEST_CHECK(frame(hazy) < SameFrame * bare);
            DOCTEST_CHECK(frame(hazy) > bare / SameFrame);
            DOCTEST_CHECK(framing_bounds(GaussianSet(hazy)).radius() < 1.1 * box);
            const auto statistics = compute_statistics(GaussianSet(hazy));
            DOCTEST_CHECK(statistics.haze_rows > static_cast<std::size_t>(count) * 8 / 10);
            DOCTEST_CHECK(statistics.visible_rows == hazy.size());
        }
}

DOCTEST_TEST_CASE("a sky ball, a dome, and scattered opaque floaters leave the frame as it was") {
    Random random(2);
    const GaussianData scene = thing_on_ground(random);
    const double bare = frame(scene);
    for (const int kind : {0, 1, 2}) {
        GaussianData around = scene;
        for (int i = 0; i < 400; ++i) {
            Vec3 at = in_ball(random);
            if (kind < 2) at = normalized(at);
            if (kind == 1) at.y = -std::abs(at.y);
            add(around, at * 60.0, 0.95, kind < 2 ? 2.2 : 0.1);
        }
        DOCTEST_CAPTURE(kind);
        DOCTEST_CHECK(frame(around) < SameFrame * bare);
        const auto statistics = compute_statistics(GaussianSet(around));
        DOCTEST_CHECK((kind < 2 ? statistics.sky_rows : statistics.haze_rows) > 390);
    }
}

DOCTEST_TEST_CASE("nothing is taken for haze in a scene alone, nor a second thing, nor a room around it") {
    Random random(3);
    const GaussianData scene = thing_on_ground(random);
    DOCTEST_CHECK(surrounding_rows(GaussianSet(scene)).empty());
    GaussianData two = scene;  // a smaller ball, well away
    for (int i = 0; i < 800; ++i) add(two, normalized(in_ball(random)) * 0.5 + Vec3{25, 0, 0}, 0.9, 0.05);
    DOCTEST_CHECK(surrounding_rows(GaussianSet(two)).empty());
    GaussianData room = scene;  // walls whose splats touch
    for (int i = 0; i < 4000; ++i) {
        Vec3 at{random.uniform() * 16 - 8, random.uniform() * 16 - 8, random.uniform() * 16 - 8};
        at[i % 3] = i % 2 == 0 ? 8 : -8;
        add(room, at, 0.9, 0.2);
    }
    DOCTEST_CHECK(compute_statistics(GaussianSet(room)).haze_rows == 0);
    DOCTEST_CHECK(surrounding_rows(GaussianSet()).empty());
}

}  // namespace surroundings_test
