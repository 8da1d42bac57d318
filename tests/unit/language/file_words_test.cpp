// Words in the names of files, and the things that they name.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/language/plan/words/file_words.h"

namespace file_words_test {

using namespace gse::language::plan;

DOCTEST_TEST_CASE("words of a file's name end at separators, digits and capitals") {
    using Words = std::vector<std::string>;
    DOCTEST_CHECK(words_of_file_name("my-guitar_v2") == Words{"my", "guitar", "v"});
    DOCTEST_CHECK(words_of_file_name("Guitar 01") == Words{"guitar"});
    DOCTEST_CHECK(words_of_file_name("redGuitar3Scan") == Words{"red", "guitar", "scan"});
    DOCTEST_CHECK(words_of_file_name("LEGOHouse") == Words{"lego", "house"});
    DOCTEST_CHECK(words_of_file_name("_12-").empty());
}

DOCTEST_TEST_CASE("the last word that names a thing is the thing's") {
    for (const auto& [name, thing] : {std::pair{"object_guitar", "guitar"},
                                      {"my-guitar_v2", "guitar"},
                                      {"Guitar 01", "guitar"},
                                      {"Guitar", "guitar"},
                                      {"guitar_scan_final", "guitar"},
                                      {"room_kitchen", "kitchen"},
                                      {"outdoor_luma-seal", "seal"},
                                      {"plant_lastchance", "plant"},
                                      {"object_lego-house_sh3", "house"},
                                      {"lego_bulldozer", "bulldozer"},
                                      {"playbot_2", "playbot"},  // no word: the last one
                                      {"object_3", "object"}})   // nothing else is left
        DOCTEST_CHECK_MESSAGE(thing_of_file_name(name) == thing, name);
}

DOCTEST_TEST_CASE("a name in plain words is its own") {
    for (const char* name : {"guitar", "teddy bear", "", "12", "left hand"})
        DOCTEST_CHECK_MESSAGE(thing_of_file_name(name).empty(), name);
}

}  // namespace file_words_test
