// Unknown nouns that are other words for known ones.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/language/synonyms.h"

namespace synonyms_test {

using namespace gse::language;

DOCTEST_TEST_CASE("another word for a known one leads to it, in the plural too") {
    const std::vector<std::string> known{"bear", "dog", "cat", "car", "couch", "hat", "glasses", "flower"};
    for (const auto& [typed, expected] : {std::pair{"puppy", "dog"},
                                          {"puppies", "dog"},
                                          {"kitten", "cat"},
                                          {"automobile", "car"},
                                          {"sofa", "couch"},
                                          {"specs", "glasses"},
                                          {"blossoms", "flower"},
                                          {"bruin", "bear"}})
        DOCTEST_CHECK(known_synonym(typed, known) == expected);
    // A noun of the same kind, a wider one and a known one are no other words.
    for (const char* typed :
         {"seal", "wolf", "panda", "animal", "vehicle", "cap", "helmet", "dog", "skull", ""})
        DOCTEST_CHECK(known_synonym(typed, known).empty());
    DOCTEST_CHECK(known_synonym("puppy", {"cat"}).empty());
    DOCTEST_CHECK(known_synonym("puppy", {}).empty());  // a model of any word
    DOCTEST_CHECK(known_synonym("bike", {"motorcycle"}) == "motorcycle");
}

DOCTEST_TEST_CASE("a phrase keeps its other words and marks") {
    const std::vector<std::string> known{"dog", "brown", "a", "hat"};
    const auto phrase = in_known_words("A brown puppy, wearing a hat", known);
    DOCTEST_CHECK(phrase.text == "A brown dog, wearing a hat");
    DOCTEST_REQUIRE(phrase.replaced.size() == 1);
    DOCTEST_CHECK(other_word_text(phrase.replaced[0]) ==
                  "Looks for \"dog\": \"puppy\" is another word for it");
    DOCTEST_CHECK(in_known_words("a skull", known).text == "a skull");
    DOCTEST_CHECK(in_known_words("", known).text.empty());
}

}  // namespace synonyms_test
