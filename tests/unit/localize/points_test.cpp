// Rules of the clicks: highest inside, lowest outside, all at a distance.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/localize/clusters.h"
#include "engine/localize/points.h"

namespace points_test {

namespace {

using namespace gse;

struct Scene {
    Image map{64, 64, 1};
    Mask region;
};

/// A noisy bump and the region where it is above one half.
Scene bump(double cx, double cy, double width, std::uint64_t seed) {
    Scene scene;
    Random random(seed);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            scene.map.at(x, y, 0) = static_cast<float>(
                std::exp(-(std::pow(x - cx, 2) + std::pow(y - cy, 2)) / (2 * width * width)) +
                0.05 * random.uniform());
    scene.region = localize::threshold_map(scene.map, 0.5);
    return scene;
}

double distance(const localize::Point& a, const localize::Point& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

DOCTEST_TEST_CASE("five clicks inside and three outside, apart from each other") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = bump(20 + static_cast<double>(seed), 30, 6 + static_cast<double>(seed % 5), seed);
        const auto points = localize::choose_points(scene.map, scene.region);
        int positive = 0;
        for (const auto& point : points) {
            const bool inside = scene.region.at(static_cast<int>(point.x), static_cast<int>(point.y)) != 0;
            DOCTEST_CHECK(inside == point.positive);
            positive += point.positive ? 1 : 0;
        }
        DOCTEST_CHECK(positive == 5);
        DOCTEST_CHECK(points.size() == 8);
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                if (points[i].positive && points[j].positive)
                    DOCTEST_CHECK(distance(points[i], points[j]) >= 2);
                if (!points[i].positive && !points[j].positive)
                    DOCTEST_CHECK(distance(points[i], points[j]) >= 8);
            }
        const Mask margin = localize::dilate(scene.region, 4);
        for (const auto& point : points)
            if (!point.positive)
                DOCTEST_CHECK(margin.at(static_cast<int>(point.x), static_cast<int>(point.y)) == 0);
    }
}

DOCTEST_TEST_CASE("the first click is the maximum, and each further one the best that is far enough") {
    const Scene scene = bump(32, 32, 9, 4);
    const auto points = localize::choose_points(scene.map, scene.region);
    std::vector<localize::Point> chosen;
    const double spacing = distance(points[0], points[1]) < 4 ? 0 : 2;  // at least the two-pixel rule
    for (const auto& point : points) {
        if (!point.positive) continue;
        const float mine = scene.map.at(static_cast<int>(point.x), static_cast<int>(point.y), 0);
        if (chosen.empty())
            for (const float value : scene.map.data) DOCTEST_CHECK(mine >= value);
        else
            DOCTEST_CHECK(mine <= scene.map.at(static_cast<int>(chosen.back().x),
                                               static_cast<int>(chosen.back().y), 0));
        for (const auto& other : chosen) DOCTEST_CHECK(distance(point, other) >= spacing);
        chosen.push_back(point);
    }
}

DOCTEST_TEST_CASE("equal lows go to the corner farthest from the clicks inside") {
    Scene scene;
    for (int y = 10; y < 20; ++y)
        for (int x = 10; x < 20; ++x) scene.map.at(x, y, 0) = 1;
    scene.region = localize::threshold_map(scene.map, 0.5);
    const auto points = localize::choose_points(scene.map, scene.region);
    const auto first =
        std::find_if(points.begin(), points.end(), [](const auto& point) { return !point.positive; });
    DOCTEST_REQUIRE(first != points.end());
    DOCTEST_CHECK(first->x == 63.5);
    DOCTEST_CHECK(first->y == 63.5);
}

DOCTEST_TEST_CASE("small regions and full pictures give fewer clicks, never wrong ones") {
    Scene scene;
    scene.region = Mask(64, 64);
    scene.region.at(5, 5) = 1;
    const auto one = localize::choose_points(scene.map, scene.region);
    DOCTEST_CHECK(std::count_if(one.begin(), one.end(), [](const auto& point) { return point.positive; }) ==
                  1);
    const auto full = localize::choose_points(Image(64, 64, 1, 1), Mask(64, 64, 1));
    DOCTEST_CHECK(std::all_of(full.begin(), full.end(), [](const auto& point) { return point.positive; }));
    const auto none = localize::choose_points(Image(64, 64, 1), Mask(64, 64));
    DOCTEST_CHECK(std::none_of(none.begin(), none.end(), [](const auto& point) { return point.positive; }));
}

DOCTEST_TEST_CASE("captured mass is the share of the region's attention") {
    Image map(4, 1, 1);
    map.data = {1, 3, 4, 100};
    Mask region(4, 1), mask(4, 1);
    region.data = {1, 1, 1, 0};
    mask.data = {0, 1, 0, 1};
    DOCTEST_CHECK(localize::captured_mass(map, region, mask) == doctest::Approx(3.0 / 8));
    DOCTEST_CHECK(localize::captured_mass(map, Mask(4, 1), mask) == 0);
}

}  // namespace points_test
