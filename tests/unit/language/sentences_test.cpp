// Readings of 745 sentences, pinned in sentences.jsonl. Lines with "was" name the reading of an earlier
// splitter of words (hyphens, invisible characters).
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/language/news.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "tests/test_paths.h"

namespace sentences_test {

namespace {

using namespace gse;
using namespace gse::language;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

constexpr const char* Relations[] = {"none", "above", "beside", "left", "right", "behind", "before", "under"};
constexpr const char* Modes[] = {"modify", "add", "replace"};

std::filesystem::path folder() { return test::source_folder() / "tests/unit/language"; }

Words left_out(const Sentence& sentence, const Words& known) {
    Words words;
    for (const auto& word : sentence.words())
        for (auto& part : match_word(word, known).left_out) words.push_back(std::move(part));
    return words;
}

Json edit_of(const Sentence& sentence, const std::string& source, const std::string& target) {
    const EditSentence words(sentence, source, target);
    const auto [mode, reason] = decide_mode(words, std::nullopt);
    return {{"source", source},
            {"target", target},
            {"mode", Modes[static_cast<int>(mode)]},
            {"reason", reason},
            {"relation", Relations[static_cast<int>(words.relation())]},
            {"before", words.before()},
            {"in_place", words.replacement()},
            {"things", Sentence(words.before()).things({source})},
            {"instruction", instruction_for(sentence, source)}};
}

void check_fields(const Json& pinned, const Json& found) {
    for (const auto& [key, value] : found.items()) {
        DOCTEST_INFO(key);
        DOCTEST_CHECK(pinned.at(key).dump() == value.dump());
    }
}

}  // namespace

DOCTEST_TEST_CASE("745 sentences are read as they were") {
    const auto vocabulary = Json::parse(std::ifstream(folder() / "starter_vocabulary.json"));
    const auto known = vocabulary.at("vocabulary").get<Words>();
    const auto sayable = promptable_vocabulary(known, vocabulary.at("drawn").get<Words>());
    std::ifstream lines(folder() / "sentences.jsonl");
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        const auto pinned = Json::parse(line);
        const auto text = pinned.at("sentence").get<std::string>();
        DOCTEST_INFO(text);
        const Sentence sentence(text);
        const auto source = normalised_prompt(pinned.at("source").get<std::string>());
        const auto said = pinned.at("said").get<Words>();
        check_fields(pinned, {{"words", sentence.prompt()},
                              {"told", filter_to_vocabulary(sentence.prompt(), sayable, Identifier)},
                              {"found_by", filter_to_vocabulary(sentence.prompt(), known)},
                              {"left_out", left_out(sentence, sayable)},
                              {"guess", guessed_target(sentence, source)},
                              {"guess_said", guessed_target(sentence, source, said)},
                              {"possible", possible_targets(sentence, source, said)}});
        const auto& edit = pinned.at("edit");
        if (!edit.contains("error"))
            check_fields(edit, edit_of(sentence, source, edit.at("target").get<std::string>()));
    }
    DOCTEST_CHECK(count == 745);
}

DOCTEST_TEST_CASE("a sentence that repeats what is worn has its news in the ground") {
    const Words said{"a", "bear", "wearing", "red", "hat"};
    const auto guess = [&](const char* text) { return guessed_target(Sentence(text), "bear", said); };
    DOCTEST_CHECK(guess("a bear wearing a red hat in the snow") == "snow");
    DOCTEST_CHECK(guess("a golden bear wearing a red hat in the snow") == "golden");
    DOCTEST_CHECK(guess("a bear wearing a scarf in the snow") == "scarf");
    DOCTEST_CHECK(guess("a bear wearing a red hat") == "hat");
    DOCTEST_CHECK(guessed_target(Sentence("a bear wearing a red hat in the snow"), "bear") == "hat");
}

DOCTEST_TEST_CASE("what a model is told and what is said to be left out agree") {
    const Words known{"a", "red", "and", "white", "bear", "hat"};
    const auto match = [&](const std::string& word) { return match_word(word, known); };
    DOCTEST_CHECK(filter_to_vocabulary("a rose-red bear", known) == "a red bear");
    DOCTEST_CHECK(match("rose-red").kept == Words{"red"});
    DOCTEST_CHECK(match("rose-red").left_out == Words{"rose"});
    DOCTEST_CHECK(filter_to_vocabulary("a red-and-white hat", known) == "a red and white hat");
    DOCTEST_CHECK(match("red-and-white").left_out.empty());
    DOCTEST_CHECK(match("t-shirt").left_out == Words{"t-shirt"});
    DOCTEST_CHECK(match_word("t-shirt", {"t-shirt", "shirt"}).kept == Words{"t-shirt"});
    DOCTEST_CHECK(filter_to_vocabulary("a * bear, no hat,", known, Identifier) == "a * bear, hat");
}

DOCTEST_TEST_CASE("invisible characters lose no word") {
    DOCTEST_CHECK(words_of("a blue\u200b bear") == Words{"a", "blue", "bear"});
    DOCTEST_CHECK(words_of("a bl\u200bue b\u2064ear\u180e") == Words{"a", "blue", "bear"});
    DOCTEST_CHECK(words_of("\u200b\u200d a\u200b \u2060blue\ufe0f \U000e0001bear") ==
                  Words{"a", "blue", "bear"});
    DOCTEST_CHECK(words_of("\u200b\ufeff").empty());
    DOCTEST_CHECK(words_of("a \xe2\x80 bear\xff") == Words{"a", "\xe2\x80", "bear\xff"});
    DOCTEST_CHECK(words_of("\ufeffa gr\u00adeen bear\u2060") == Words{"a", "green", "bear"});
    DOCTEST_CHECK(words_of("a\u2009red\u3000bear\u2028hat") == Words{"a", "red", "bear", "hat"});
}

DOCTEST_TEST_CASE("noun phrases have a joint, attributes and a head") {
    const auto phrases =
        Sentence("a big teddy bear next to a red hat on the grass").noun_phrases({"teddy bear"});
    DOCTEST_REQUIRE(phrases.size() == 3);
    DOCTEST_CHECK(phrases[0].joint.empty());
    DOCTEST_CHECK(phrases[0].attributes == Words{"big"});
    DOCTEST_CHECK(phrases[0].head == "teddy bear");
    DOCTEST_CHECK(phrases[1].joint == "next to");
    DOCTEST_CHECK(phrases[1].attributes == Words{"red"});
    DOCTEST_CHECK(phrases[1].head == "hat");
    DOCTEST_CHECK(phrases[2].joint == "on");
    DOCTEST_CHECK(phrases[2].begin == 8);
    DOCTEST_CHECK(Sentence("on the").noun_phrases().empty());
}

}  // namespace sentences_test
