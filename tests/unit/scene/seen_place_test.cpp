// Places in front of what a view shows: rooms whose surfaces are known are looked at from several sides.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "tests/unit/scene/seen_blocks.h"

namespace seen_place_test {

namespace {

using namespace gse;
using test::Block;
using test::seen;

constexpr double Off = 0.02;  // of heights: a pixel of the view
constexpr double Deep = 1e-6;

const Block Floor{{-4, -0.1, -4}, {4, 0, 4}};
const Block Wall{{-4, 0, 1}, {4, 3, 1.2}};
const Block Table{{-0.6, 0, -0.6}, {0.6, 0.7, 0.6}};

/// True where all corners of the box are in the picture with nothing in front of them.
bool is_seen_whole(const SeenSurface& surface, const SeenPlace& place, const Vec3& size) {
    const Camera& camera = surface.camera;
    for (const double x : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5})
            for (const double y : {0.1, 1.0}) {
                const Vec3 corner = place.foot + Vec3{x * size.x, y * size.y, z * size.z} * place.factor;
                const Vec3 at = camera.to_camera(corner);
                const double px = camera.fx * at.x / at.z + camera.cx,
                             py = camera.fy * at.y / at.z + camera.cy;
                if (!(at.z > 0 && px >= 0 && py >= 0 && px < camera.width && py < camera.height))
                    return false;
                const float depth = surface.depth.at(static_cast<int>(px), static_cast<int>(py), 0);
                if (depth > 0 && at.z > depth + Deep) return false;
            }
    return true;
}

double seen_share(const SeenSurface& surface, const SeenPlace& place, double size) {
    const Vec3 at = surface.camera.to_camera(place.foot);
    return size * place.factor * surface.camera.fy / (at.z * surface.camera.height);
}

}  // namespace

DOCTEST_TEST_CASE("it stands in front of the wall at the middle of the view, from every side") {
    const Vec3 size{0.4, 0.8, 0.4};
    for (const double side : {-0.9, -0.4, 0.0, 0.5, 1.0})
        for (const double height : {0.8, 1.5, 2.5}) {
            const Vec3 eye{5 * std::sin(side), height, 1 - 5 * std::cos(side)};
            const auto surface = seen({Floor, Wall}, eye, {0, 0.8, 1});
            const SeenPlace place = seen_place(surface, size, false);
            DOCTEST_CAPTURE(side);
            DOCTEST_CAPTURE(height);
            DOCTEST_CHECK(place.stands);
            DOCTEST_CHECK(place.suits);
            DOCTEST_CHECK(std::abs(place.foot.y) < Off);
            DOCTEST_CHECK(place.foot.z + size.z / 2 <= 1 + Deep);
            DOCTEST_CHECK(is_seen_whole(surface, place, size));
        }
}

DOCTEST_TEST_CASE("what lies behind the wall is never chosen, though the scene's middle lies there") {
    const Block house{{-3, 0, 1}, {3, 2.5, 9}};  // its front hides its inside
    const auto surface = seen({{{-9, -0.1, -9}, {9, 0, 19}}, house}, {0, 1.5, -6}, {0, 1.2, 5});
    const Vec3 size{0.5, 1, 0.5};
    const SeenPlace place = seen_place(surface, size, false);
    DOCTEST_CHECK(place.stands);
    DOCTEST_CHECK(place.foot.z < 1);
    DOCTEST_CHECK(is_seen_whole(surface, place, size));
}

DOCTEST_TEST_CASE("a table at the middle of the view carries it") {
    const auto surface = seen({Floor, Table}, {0, 1.8, -3}, {0, 0.8, 0});
    const Vec3 size{0.3, 0.4, 0.3};
    const SeenPlace place = seen_place(surface, size, false);
    DOCTEST_CHECK(place.stands);
    DOCTEST_CHECK(std::abs(place.foot.y - 0.7) < Off);
    DOCTEST_CHECK(std::abs(place.foot.x) + size.x / 2 < 0.65);
    DOCTEST_CHECK(is_seen_whole(surface, place, size));
}

DOCTEST_TEST_CASE("a size that cannot be seen is changed, and one that is given is kept") {
    const auto surface = seen({Floor, Wall}, {0, 1.5, -4}, {0, 0.6, 1});
    const Vec3 shape{0.5, 1, 0.5};
    for (const double size : {0.001, 0.05, 40.0, 9000.0}) {
        const SeenPlace place = seen_place(surface, shape * size, false);
        DOCTEST_CAPTURE(size);
        DOCTEST_CHECK_FALSE(place.suits);
        const double share = seen_share(surface, place, size);
        DOCTEST_CHECK(share > 1.0 / 12);
        DOCTEST_CHECK(share < 0.6);
        DOCTEST_CHECK(is_seen_whole(surface, place, shape * size));
        DOCTEST_CHECK(seen_place(surface, shape * size, true).factor == 1);
    }
}

DOCTEST_TEST_CASE("it hangs in front of a wall that shows no floor, and before the only thing in the sky") {
    for (const auto& blocks : {std::vector<Block>{Wall}, {{{1, 1.8, 1}, {1.2, 2, 1.2}}}}) {
        const auto surface = seen(blocks, {0, 1.5, -2}, {0, 1.5, 1});
        const Vec3 size{0.3, 0.3, 0.3};
        const SeenPlace place = seen_place(surface, size, false);
        DOCTEST_CHECK_FALSE(place.stands);
        DOCTEST_CHECK(is_seen_whole(surface, place, size));
    }
    DOCTEST_CHECK(SeenSurface{}.empty());
    DOCTEST_CHECK(seen({}, {0, 1, 0}, {1, 1, 1}).empty());
}

}  // namespace seen_place_test
