// Suggestions are near in spelling, or there are none.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/spelling.h"

namespace spelling_test {

DOCTEST_TEST_CASE("the nearest word is the one that shares most letters") {
    const std::vector<std::string> known{"an", "bear", "golden", "statue", "hat"};
    DOCTEST_CHECK(gse::nearest_word("baer", known) == "bear");
    DOCTEST_CHECK(gse::nearest_word("gold", known) == "golden");
    DOCTEST_CHECK(gse::nearest_word("hats", known) == "hat");
    DOCTEST_CHECK(gse::nearest_word("plant", known).empty());  // "an" is in it, which is no help
    DOCTEST_CHECK(gse::nearest_word("bear", {}).empty());
}

DOCTEST_TEST_CASE("spelling distance is a metric between 0 and 1") {
    DOCTEST_CHECK(gse::spelling_distance("", "") == 0);
    DOCTEST_CHECK(gse::spelling_distance("bear", "bear") == 0);
    DOCTEST_CHECK(gse::spelling_distance("abc", "xyz") == 1);
    DOCTEST_CHECK(gse::spelling_distance("cat", "car") == gse::spelling_distance("car", "cat"));
}

}  // namespace spelling_test
