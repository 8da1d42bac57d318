// DBSCAN on the grid against its definition; cleaning, growing and resizing of masks.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "engine/base/random.h"
#include "engine/localize/clusters.h"

namespace clusters_test {

namespace {

using gse::Image;
using gse::Mask;

Mask random_mask(int width, int height, double density, std::uint64_t seed) {
    gse::Random random(seed);
    Mask mask(width, height);
    for (auto& value : mask.data) value = random.uniform() < density ? 1 : 0;
    return mask;
}

/// DBSCAN by its definition: all pairs of points, transitive closure by repeated relabelling.
std::vector<int> brute_force(const Mask& mask, double eps, int min_samples) {
    struct Pixel {
        int x, y;
        std::size_t index;
    };
    std::vector<Pixel> pixels;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y) != 0) pixels.push_back({x, y, static_cast<std::size_t>(y * mask.width + x)});
    const auto near = [&](const Pixel& a, const Pixel& b) {
        return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) <= eps * eps;
    };
    std::vector<bool> core;
    for (const auto& a : pixels) {
        int count = 0;
        for (const auto& b : pixels) count += near(a, b) ? 1 : 0;
        core.push_back(count >= min_samples);
    }
    std::vector<std::size_t> group(pixels.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            for (std::size_t j = 0; j < pixels.size(); ++j)
                if (core[i] && core[j] && group[j] > group[i] && near(pixels[i], pixels[j])) {
                    group[j] = group[i];
                    changed = true;
                }
    }
    std::vector<int> number(pixels.size(), -1), result(mask.data.size(), -1);
    int next = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (!core[i]) continue;
        if (number[group[i]] < 0) number[group[i]] = next++;
        result[pixels[i].index] = number[group[i]];
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (core[i]) continue;
        for (std::size_t j = 0; j < pixels.size(); ++j)
            if (core[j] && near(pixels[i], pixels[j])) {
                int& mine = result[pixels[i].index];
                const int other = number[group[j]];
                mine = mine < 0 ? other : std::min(mine, other);
            }
    }
    return result;
}

Image flat_map(const Mask& mask, float value) { return {mask.width, mask.height, 1, value}; }

void fill(Mask& mask, int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) mask.at(x, y) = 1;
}

}  // namespace

DOCTEST_TEST_CASE("grid DBSCAN equals the definition on random masks") {
    int clusters_seen = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const double density = 0.05 + 0.5 * static_cast<double>(seed) / 60;
        const Mask mask = random_mask(19, 14 + static_cast<int>(seed % 5), density, seed);
        for (const auto& [eps, min_samples] : {std::pair{1.0, 3}, {1.5, 4}, {2.0, 4}, {3.0, 9}, {2.5, 1}}) {
            const auto fast = gse::localize::dbscan(mask, {eps, min_samples});
            DOCTEST_CHECK(fast == brute_force(mask, eps, min_samples));
            clusters_seen += *std::max_element(fast.begin(), fast.end()) + 1;
        }
    }
    DOCTEST_CHECK(clusters_seen > 300);  // the masks were not all noise
}

DOCTEST_TEST_CASE("eps below one pixel makes everything noise when a neighbour is asked for") {
    const Mask mask(8, 8, 1);
    for (const int cluster : gse::localize::dbscan(mask, {0.5, 2})) DOCTEST_CHECK(cluster == -1);
}

DOCTEST_TEST_CASE("a border pixel between two clusters joins the lower one") {
    Mask mask(9, 3);
    fill(mask, 0, 0, 3, 3);
    fill(mask, 6, 0, 9, 3);
    mask.at(4, 1) = 1;  // within 2 px of both, itself not core
    const auto clusters = gse::localize::dbscan(mask, {2, 6});
    DOCTEST_CHECK(clusters[static_cast<std::size_t>(1 * 9 + 4)] == 0);
    DOCTEST_CHECK(clusters[static_cast<std::size_t>(1 * 9 + 7)] == 1);
}

DOCTEST_TEST_CASE("cleaning keeps the heaviest cluster and those with enough of its mass, and drops specks") {
    Mask mask(64, 64);
    fill(mask, 5, 5, 15, 15);    // 100 pixels
    fill(mask, 30, 5, 36, 11);   // 36 pixels: kept at 25 %
    fill(mask, 30, 30, 34, 34);  // 16 pixels: dropped
    mask.at(60, 60) = 1;         // noise
    const Mask clean = gse::localize::clean_clusters(mask, flat_map(mask, 1), {2, 4}, 0.25);
    DOCTEST_CHECK(clean.count() == 136);
    DOCTEST_CHECK(clean.at(32, 32) == 0);
    DOCTEST_CHECK(clean.at(60, 60) == 0);
    // Mass counts, not area: a faint large cluster gives way to a strong small one.
    Image map = flat_map(mask, 0.1f);
    for (int y = 30; y < 34; ++y)
        for (int x = 30; x < 34; ++x) map.at(x, y, 0) = 5;
    const Mask strong = gse::localize::clean_clusters(mask, map, {2, 4}, 0.25);
    DOCTEST_CHECK(strong.count() == 16);
    DOCTEST_CHECK(strong.at(31, 31) == 1);
    DOCTEST_CHECK(gse::localize::clean_clusters(Mask(8, 8), Image(8, 8, 1), {2, 4}, 0.25).count() == 0);
}

DOCTEST_TEST_CASE("dilation is the set of pixels within the radius; shrinking undoes it on convex shapes") {
    const Mask mask = random_mask(23, 17, 0.03, 5);
    for (const double radius : {0.0, 1.0, 1.5, 3.0}) {
        const Mask grown = gse::localize::dilate(mask, radius);
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x) {
                bool near = false;
                for (int v = 0; v < mask.height; ++v)
                    for (int u = 0; u < mask.width; ++u)
                        near |= mask.at(u, v) != 0 && std::hypot(u - x, v - y) <= radius;
                DOCTEST_REQUIRE((grown.at(x, y) != 0) == near);
            }
    }
    Mask square(30, 30);
    fill(square, 10, 10, 20, 20);
    DOCTEST_CHECK(gse::localize::dilate(gse::localize::dilate(square, 3), -3).data == square.data);
}

DOCTEST_TEST_CASE("resizing keeps constants, and means when shrinking by whole factors") {
    gse::Random random(3);
    Image image(48, 32, 1);
    double mean = 0;
    for (auto& value : image.data) mean += value = static_cast<float>(random.uniform());
    mean /= static_cast<double>(image.data.size());
    const Image small = gse::localize::resize_image(image, 12, 8);
    double small_mean = 0;
    for (const auto value : small.data) small_mean += value;
    constexpr double FloatSum = 1e-5;  // sums of a thousand floats
    DOCTEST_CHECK(small_mean / 96 == doctest::Approx(mean).epsilon(FloatSum));
    for (const int side : {1, 7, 64, 200})
        for (const auto value : gse::localize::resize_image(Image(33, 21, 3, 0.25f), side, side).data)
            DOCTEST_REQUIRE(value == doctest::Approx(0.25).epsilon(FloatSum));
    Mask mask(10, 10);
    fill(mask, 5, 0, 10, 10);
    DOCTEST_CHECK(gse::localize::resize_mask(mask, 40, 20).count() == 400);
}

DOCTEST_TEST_CASE("thresholds are strict") {
    Image map(2, 1, 1);
    map.data = {0.5f, 0.51f};
    const Mask mask = gse::localize::threshold_map(map, 0.5);
    DOCTEST_CHECK(mask.data[0] == 0);
    DOCTEST_CHECK(mask.data[1] == 1);
}

DOCTEST_TEST_CASE("holes: what is enclosed is filled, what is open to the edge is not") {
    const std::vector<std::string> rows{"#####..#", "#...#.##", "#.#.#..#",
                                        "#...#.##", "#####..#", ".....###"};
    Mask mask(8, 6);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x)
            mask.at(x, y) = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#' ? 1 : 0;
    const Mask filled = gse::localize::without_holes(mask);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x) {
            const bool enclosed = x > 0 && x < 4 && y > 0 && y < 4;
            DOCTEST_CHECK_MESSAGE(filled.at(x, y) == (enclosed || mask.at(x, y) != 0 ? 1 : 0), x, " ", y);
        }
    const Mask around = gse::localize::flood_fill(mask, filled);  // all that is set is its own way
    for (std::size_t i = 0; i < mask.data.size(); ++i) DOCTEST_CHECK(around.data[i] == mask.data[i]);
}

DOCTEST_TEST_CASE("bounds: the smallest box that holds all set pixels, none where none is set") {
    Mask mask(9, 7);
    DOCTEST_CHECK(gse::localize::bounds_of(mask).width == 0);
    mask.at(3, 6) = mask.at(8, 2) = 1;
    const auto box = gse::localize::bounds_of(mask);
    DOCTEST_CHECK((box.left == 3 && box.top == 2 && box.width == 6 && box.height == 5));
}

}  // namespace clusters_test
