// Phrases of several words and DreamBooth's "*" wherever a request's words are used.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/base/error.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/request.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/edit/search/locate.h"
#include "engine/edit/search/vocabulary_ranker.h"
#include "engine/language/grammar.h"
#include "engine/language/news.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace words_test {

namespace {

using namespace gse;
using edit::EditRequest;
using Words = std::vector<std::string>;

edit::CheckedRequest valid(const std::string& source, const std::string& prompt, const std::string& target) {
    EditRequest request;
    request.source = source;
    request.prompt = prompt;
    request.target = target;
    return edit::check(request);
}

/// Writes down the sentences it is asked for; all fit all pictures.
class ListeningScore : public edit::ImageTextEncoder {
public:
    explicit ListeningScore(Words& sentences) : sentences_(sentences) {}
    std::vector<float> image(const Image&) override { return {1.0f}; }
    std::vector<float> text(const std::string& sentence) override {
        sentences_.push_back(sentence);
        return {1.0f};
    }

private:
    Words& sentences_;
};

}  // namespace

DOCTEST_TEST_CASE("words keep the identifier and lose punctuation; the model is told just them") {
    DOCTEST_CHECK(language::words_of("A * bear, wearing (a) Hat.") ==
                  Words{"a", "*", "bear", "wearing", "a", "hat"});
    DOCTEST_CHECK(language::words_of("a *bear") == Words{"a", "*", "bear"});
    DOCTEST_CHECK(language::normalised_prompt("  A  * bear,\twearing a T-shirt!") ==
                  "a * bear wearing a t-shirt");
    DOCTEST_CHECK(language::normalised_prompt(language::normalised_prompt("A * bear.")) ==
                  language::normalised_prompt("A * bear."));
    DOCTEST_CHECK(language::without_identifier("A * bear") == "a bear");
    DOCTEST_CHECK(!language::says_something("*"));
}

DOCTEST_TEST_CASE("a phrase is in a sentence when its words follow each other") {
    DOCTEST_CHECK(language::has_phrase("A teddy bear.", "teddy bear"));
    DOCTEST_CHECK(language::has_phrase("A teddy bear.", "Teddy  Bear"));
    DOCTEST_CHECK(!language::has_phrase("a bear named teddy", "teddy bear"));
    DOCTEST_CHECK(!language::has_phrase("a teddy bearing gifts", "teddy bear"));
    DOCTEST_CHECK(!language::has_phrase("a teddy bear", ""));
    DOCTEST_CHECK(language::position_of("a brown teddy bear", "teddy bear") == 2);
    DOCTEST_CHECK(language::terms_of(language::words_of("a teddy bear and a bear"), {"bear", "teddy bear"}) ==
                  Words{"a", "teddy bear", "and", "a", "bear"});
    DOCTEST_CHECK(language::phrases_of("hat grass") == Words{"hat", "grass"});
    DOCTEST_CHECK(language::phrases_of("top hat, grass,") == Words{"top hat", "grass"});
}

DOCTEST_TEST_CASE(
    "what a text processor makes of a sentence is the same sentence, and what belongs to a thing names it") {
    DOCTEST_CHECK(language::words_of("\u201ca golden\u00a0bear\u201d\u2026") == Words{"a", "golden", "bear"});
    DOCTEST_CHECK(language::words_of("the bear\u2019s hat \u2014 red") == Words{"the", "bear", "hat", "red"});
    DOCTEST_CHECK(language::words_of("the dogs' 'ball' isn't red") ==
                  Words{"the", "dogs", "ball", "isn't", "red"});
    DOCTEST_CHECK(language::words_of("' 's ''") == Words{"s"});
    DOCTEST_CHECK(language::words_of("\u00e9t\u00e9") == Words{"\u00e9t\u00e9"});
    DOCTEST_CHECK(valid("bear", "the bear's hat is red", "hat").source() == "bear");
}

DOCTEST_TEST_CASE(
    "source and target may be phrases; they must have a word, and the target must be in the sentence") {
    const auto request = valid("Teddy  Bear", "a teddy bear wearing a Top Hat", "top hat");
    DOCTEST_CHECK(request.source() == "teddy bear");
    DOCTEST_CHECK(request.target() == "top hat");
    DOCTEST_CHECK(valid("teddy bear", "a teddy bear wearing a top hat", "").target() == "hat");
    DOCTEST_CHECK(valid("teddy bear", "a golden teddy bear", "").target() == "golden");
    DOCTEST_CHECK_THROWS_AS(valid("teddy bear", "a teddy bear with a hat on top", "top hat"), Error);
    DOCTEST_CHECK_THROWS_AS(valid("...", "a teddy bear", "bear"), Error);
    DOCTEST_CHECK_THROWS_AS(valid("bear", "a teddy bear", "!"), Error);
}

DOCTEST_TEST_CASE("the mode and the sentence before treat a phrase as one thing") {
    const auto mode = [](const edit::CheckedRequest& request) {
        return edit::decide_mode(request, std::nullopt).first;
    };
    DOCTEST_CHECK(mode(valid("teddy bear", "a teddy bear wearing a top hat", "top hat")) ==
                  edit::EditMode::Add);
    DOCTEST_CHECK(mode(valid("teddy bear", "a light blue teddy bear", "light blue")) ==
                  edit::EditMode::Modify);
    DOCTEST_CHECK(mode(valid("bear", "a teddy bear with a hat", "teddy bear")) == edit::EditMode::Modify);
    const auto before = [](const edit::CheckedRequest& request) { return request.sentence().before(); };
    DOCTEST_CHECK(before(valid("teddy bear", "a teddy bear wearing a top hat on the grass", "top hat")) ==
                  "a teddy bear on the grass");
    DOCTEST_CHECK(before(valid("teddy bear", "a light blue teddy bear", "light blue")) == "a teddy bear");
    DOCTEST_CHECK(before(valid("teddy bear", "a polar bear on the grass", "polar bear")) ==
                  "a teddy bear on the grass");
    DOCTEST_CHECK(before(valid("bear", "a teddy bear on the grass", "teddy bear")) == "a bear on the grass");
    DOCTEST_CHECK(before(valid("bear", "a blue * bear", "blue")) == "a * bear");
    DOCTEST_CHECK(before(valid("man", "a * clown", "clown")) == "a * man");
}

DOCTEST_TEST_CASE("things are named whole, and the identifier describes nothing") {
    DOCTEST_CHECK(language::Sentence("a teddy bear wearing a top hat").things() == Words{"bear", "hat"});
    DOCTEST_CHECK(language::Sentence("a teddy bear wearing a top hat").things({"teddy bear"}) ==
                  Words{"teddy bear", "hat"});
    DOCTEST_CHECK(language::Sentence("a * bear on grass").things() == Words{"bear", "grass"});
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a * bear"), "bear") == "bear");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue * bear"), "bear") == "blue");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a * clown"), "man") == "clown");
    // A teddy bear that became a panda can be asked for again.
    const auto said = language::words_said({valid("teddy bear", "a golden teddy bear", "golden").sentence(),
                                            valid("teddy bear", "a panda", "panda").sentence()});
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a teddy bear"), "panda", said) == "bear");
}

DOCTEST_TEST_CASE("what the model learns of the scene carries the identifier, what it keeps does not") {
    DOCTEST_CHECK(language::instance_prompt(valid("bear", "a blue bear", "blue").sentence()) ==
                  "a photo of a bear");
    DOCTEST_CHECK(language::instance_prompt(valid("bear", "a blue * bear", "blue").sentence()) ==
                  "a photo of a * bear");
    DOCTEST_CHECK(language::instance_prompt(valid("* bear", "a blue * bear", "blue").sentence()) ==
                  "a photo of a * bear");
}

DOCTEST_TEST_CASE("every word of a phrase must be known to a model with a fixed vocabulary") {
    const Words known{"a", "teddy", "bear", "hat", "wearing"};
    DOCTEST_CHECK(language::vocabulary_contains(known, "teddy bear"));
    DOCTEST_CHECK(!language::vocabulary_contains(known, "top hat"));
    DOCTEST_CHECK(!language::vocabulary_contains(known, ""));
    DOCTEST_CHECK(language::unknown_word(known, "top hat") == "top");
    const auto refused = [&](const edit::CheckedRequest& request) {
        try {
            edit::require_known_words(request, known, {}, false);
            return std::string();
        } catch (const Error& error) { return error.message(); }
    };
    DOCTEST_CHECK(refused(valid("teddy bear", "a teddy bear wearing a hat", "hat")).empty());
    DOCTEST_CHECK(refused(valid("teddy bear", "a teddy bear wearing a top hat", "top hat")).find("\"top\"") !=
                  std::string::npos);
    DOCTEST_CHECK(refused(valid("polar bear", "a polar bear wearing a hat", "hat")).find("\"polar\"") !=
                  std::string::npos);
}

DOCTEST_TEST_CASE("recognition puts other words in the place of the whole phrase") {
    Words sentences;
    edit::VocabularyRanker recognition(std::make_unique<ListeningScore>(sentences), {"a", "bear", "dog"});
    const Image picture(1, 1, 3);
    recognition.of("A teddy bear, on grass", "teddy bear", {&picture});
    DOCTEST_CHECK(sentences == Words{"a teddy bear on grass",
                                     "a dog on grass"});  // "bear" is a part of what is looked for
}

DOCTEST_TEST_CASE("a phrase goes where its last word usually goes") {
    DOCTEST_CHECK(language::usual_place("long scarf") == "neck");
    DOCTEST_CHECK(language::has_usual_place("top hat"));
    DOCTEST_CHECK(!language::has_usual_place("hat stand"));
}

DOCTEST_TEST_CASE("a scene stands on grounds, but not on a part of one") {
    DOCTEST_CHECK(language::names_scene_ground("wooden floor"));
    DOCTEST_CHECK(!language::names_scene_ground("blue lake"));
    DOCTEST_CHECK(!language::names_scene_ground("bear"));
}

}  // namespace words_test
