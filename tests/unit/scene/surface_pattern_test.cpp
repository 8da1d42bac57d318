// Procedural patterns.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "engine/base/random.h"
#include "engine/scene/surface_pattern.h"

namespace surface_pattern_test {

namespace {

using namespace gse;

using Colours = std::set<std::tuple<double, double, double>>;

/// Colours at 2000 points of a unit box; the same points for every pattern.
Colours colours_of(const SurfacePattern& pattern) {
    Random random(6);
    Colours colours;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 colour =
            colour_at(pattern, {random.uniform(-0.5, 0.5), random.uniform(0, 1), random.uniform(-0.5, 0.5)});
        colours.insert({colour.x, colour.y, colour.z});
    }
    return colours;
}

}  // namespace

DOCTEST_TEST_CASE("every pattern has colours that can be shown, more than one, and the same again") {
    for (const auto& word : pattern_words()) {
        DOCTEST_CAPTURE(word);
        const auto pattern = pattern_named(word);
        DOCTEST_REQUIRE(pattern);
        const auto colours = colours_of(*pattern);
        DOCTEST_CHECK(colours.size() > 1);
        DOCTEST_CHECK(colours == colours_of(*pattern));
        for (const auto& [r, g, b] : colours) {
            DOCTEST_CHECK(std::min({r, g, b}) >= 0);
            DOCTEST_CHECK(std::max({r, g, b}) <= 1.1);  // grain may be a little brighter than what it is on
        }
    }
    DOCTEST_CHECK_FALSE(pattern_named("red"));
}

DOCTEST_TEST_CASE(
    "stripes, spots and squares are of the two colours that they are given, and of nothing else") {
    for (const auto& word : pattern_words()) {
        auto pattern = *pattern_named(word);
        if (!takes_colours(pattern.kind)) continue;
        DOCTEST_CAPTURE(word);
        pattern.first = {0.1, 0.2, 0.9}, pattern.second = {0.9, 0.8, 0.1};
        DOCTEST_CHECK(colours_of(pattern) == Colours{{0.1, 0.2, 0.9}, {0.9, 0.8, 0.1}});
    }
}

DOCTEST_TEST_CASE("natural surfaces are cut out elsewhere with another offset") {
    for (const auto* word : {"marble", "lava", "camouflage", "leopard"}) {
        DOCTEST_CAPTURE(word);
        auto pattern = *pattern_named(word);
        const auto colours = colours_of(pattern);
        pattern.offset = {3.7, 1.9, 8.2};
        Random random(6);
        std::size_t other = 0;
        auto plain = pattern;
        plain.offset = {};
        for (int i = 0; i < 500; ++i) {
            const Vec3 p{random.uniform(-0.5, 0.5), random.uniform(0, 1), random.uniform(-0.5, 0.5)};
            other += colour_at(pattern, p) != colour_at(plain, p) ? 1 : 0;
        }
        DOCTEST_CHECK(other > 100);
    }
}

}  // namespace surface_pattern_test
