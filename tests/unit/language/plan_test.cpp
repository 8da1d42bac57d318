// Plans of sentences: their notation, what may never happen, and the suite of sentences where it is there.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "engine/language/plan/plan_sentence.h"
#include "engine/language/plan/words/lexicon.h"
#include "tests/test_paths.h"

namespace plan_test {

namespace {

using namespace gse;
using namespace gse::language;
using plan::Operation;

const char* const RedBear = "red bear; grass";

std::string planned(const std::string& sentence, const char* scene = RedBear, const char* source = "bear") {
    return to_string(plan::plan_sentence(sentence, plan::scene_words(scene), source));
}

struct Case {
    std::string sentence, plan;
};

const Case OfTheBear[] = {
    {"a purple bear wearing a green top hat", "recolour(bear, purple) ; add(top hat{green}, worn by, bear)"},
    {"a crocodile on the grass", "replace(bear, crocodile)"},
    {"a bear reading a newspaper on a bench", "add(newspaper, held by, bear) ; add(bench, under, bear)"},
    {"set the bear on fire", "add(flames, on, bear)"},
    {"make the bear twice as tall", "transform(bear, taller)"},
    {"move the bear 2 meters to the left", "transform(bear, move left 2 m)"},
    {"rotate the bear 90 degrees to the right", "transform(bear, rotate 90 right)"},
    {"replace the grass with snow", "ground(grass, snow)"},
    {"make everything blue except the grass", "recolour(scene except grass, blue)"},
    {"give the bear leopard spots", "pattern(bear, leopard)"},
    {"put the bear in a cage", "add(cage, around, bear)"},
    {"make the bear blue. no wait, green", "recolour(bear, green)"},
    {"a bear with a hat but no scarf", "add(hat, worn by, bear)"},
    {"add a hat, then make it blue", "add(hat{blue}, worn by, bear)"},
    {"paint the bear's paws black and its nose pink",
     "recolour(paws of bear, black) ; recolour(nose of bear, pink)"},
    {"add two more bears", "duplicate(bear, 3)"},
    {"don't make the bear blue", "none(nothing asked)"},
    {"a red bear on a lawn", "none(already so)"},
    {"turn day into night", "environment(scene, night)"},
    {"turn the scene into a watercolor", "style(scene, watercolor)"},
    {"let the bear dance", "pose(bear, dancing)"},
    {"make the bear look angry", "alter(bear, angry)"},
    {"paint the hat green", "refuse(not in scene, hat)"},
    {"make the blue bear green", "refuse(not in scene, blue bear)"},
    {"remove the bear and make it blue", "refuse(contradiction)"},
    {"is the bear blue?", "refuse(question)"},
    {"haz el oso azul", "refuse(language)"},
    {"мишка", "refuse(language)"},
    {"undo", "refuse(not an edit)"},
    {"", "refuse(empty)"},
    {"?!", "refuse(not a sentence)"},
};

/// Reads the notation: operations with balanced brackets and as many arguments as they have.
bool is_legal(const std::string& text) {
    const std::set<std::string> names{"recolour", "material",  "pattern", "transform", "pose",
                                      "alter",    "ground",    "remove",  "replace",   "add",
                                      "style",    "duplicate", "none",    "refuse",    "environment"};
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(" ; ", begin), text.size());
        const auto step = text.substr(begin, end - begin);
        const auto open = step.find('(');
        if (open == std::string::npos || step.back() != ')' || !names.contains(step.substr(0, open)))
            return false;
        const auto inside = step.substr(open + 1, step.size() - open - 2);
        if (inside.empty() || inside.front() == ' ' || inside.back() == ' ' ||
            inside.find(", ,") != std::string::npos)
            return false;
        if (std::count(step.begin(), step.end(), '{') != std::count(step.begin(), step.end(), '}'))
            return false;
        if (std::count(step.begin(), step.end(), '[') != std::count(step.begin(), step.end(), ']'))
            return false;
        begin = end + 3;
    }
    return !text.empty();
}

int rank(Operation operation) {
    switch (operation) {
        case Operation::Remove: return 2;
        case Operation::Replace: return 3;
        case Operation::Add:
        case Operation::Duplicate: return 4;
        case Operation::Style:
        case Operation::Environment: return 5;
        case Operation::None:
        case Operation::Refuse: return 6;
        default: return 1;
    }
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// A sentence of the suite: escapes of check.py resolved.
std::string unescaped(const std::string& text) {
    std::string plain;
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text[at] != '\\') {
            plain += text[at];
            continue;
        }
        const char code = text[++at];
        if (code == 'u') {
            const auto value = static_cast<unsigned>(std::stoul(text.substr(at + 1, 4), nullptr, 16));
            at += 4;
            if (value < 0x80) plain += static_cast<char>(value);
            else if (value < 0x800)
                plain += {static_cast<char>(0xc0 | value >> 6), static_cast<char>(0x80 | (value & 63))};
            else
                plain += {static_cast<char>(0xe0 | value >> 12), static_cast<char>(0x80 | (value >> 6 & 63)),
                          static_cast<char>(0x80 | (value & 63))};
        } else
            plain += code == 'n' ? '\n' : code == 't' ? '\t' : code == 'r' ? '\r' : code == 's' ? ' ' : code;
    }
    return plain;
}

std::vector<std::string> cells_of(const std::string& line, const std::string& separator) {
    std::vector<std::string> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(separator, begin), line.size());
        cells.push_back(line.substr(begin, end - begin));
        begin = end + separator.size();
    }
    return cells;
}

}  // namespace

DOCTEST_TEST_CASE("sentences and their plans") {
    for (const auto& [sentence, expected] : OfTheBear) {
        DOCTEST_INFO(sentence);
        DOCTEST_CHECK(planned(sentence) == expected);
    }
    DOCTEST_CHECK(planned("take it off", "red bear; blue hat; grass") == "remove(hat)");
    DOCTEST_CHECK(planned("a red car and a green car", "red car; blue car; road", "") ==
                  "recolour(car{blue}, green)");
    DOCTEST_CHECK(planned("make it blue", "white vase; brown chair; floor", "") == "refuse(ambiguous)");
}

DOCTEST_TEST_CASE("capitals, marks at the end, blanks and British spelling change no plan") {
    for (const auto& [sentence, expected] : OfTheBear) {
        const std::string& text = sentence;
        if (text.size() < 3 || text.back() == '?' || static_cast<unsigned char>(text[0]) > 127) continue;
        DOCTEST_INFO(sentence);
        std::string capitals = text, wide;
        std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                       [](unsigned char c) { return std::toupper(c); });
        for (const char letter : text) wide += letter == ' ' ? std::string("  ") : std::string(1, letter);
        DOCTEST_CHECK(planned(capitals) == planned(text));
        DOCTEST_CHECK(planned(text + ".") == planned(text));
        DOCTEST_CHECK(planned(" " + wide + " ") == planned(text));
        DOCTEST_CHECK(planned("\"" + text + "\"") == planned(text));
    }
    DOCTEST_CHECK(planned("colour the bear grey") == planned("color the bear gray"));
    DOCTEST_CHECK(planned("give the bear pyjamas") == planned("give the bear pajamas"));
}

DOCTEST_TEST_CASE("a word that is named is in the plan, or the plan refuses") {
    const std::vector<std::string> colours{"blue", "green", "turquoise"}, worn{"hat", "cape", "scarf"},
        things{"tree", "robot", "penguin", "lamp"};
    for (const auto& colour : colours)
        for (const auto& clothes : worn)
            for (const auto& thing : things)
                for (const auto& text : {"a " + colour + " bear wearing a " + clothes + " next to a " + thing,
                                         "paint the bear " + colour + ", give it a " + clothes +
                                             " and put a " + thing + " behind it",
                                         "a " + thing + " with a " + colour + " " + clothes}) {
                    DOCTEST_INFO(text);
                    const auto plan = planned(text);
                    const bool refused = plan.find("refuse(") != std::string::npos;
                    const bool whole = plan.find(colour) != std::string::npos &&
                                       plan.find(clothes) != std::string::npos &&
                                       plan.find(thing) != std::string::npos;
                    DOCTEST_CHECK((refused || whole));
                }
    for (const std::string strange : {"a blorfy bear", "a bear wearing a glimpf", "make the bear zxcvb"}) {
        DOCTEST_INFO(strange);
        DOCTEST_CHECK(planned(strange).find("refuse(") == 0);
    }
}

DOCTEST_TEST_CASE("token soup makes legal plans, in the order of the operations, and the same ones again") {
    const std::vector<std::string> soup{"a",
                                        "the",
                                        "bear",
                                        "hat",
                                        "grass",
                                        "blue",
                                        "make",
                                        "put",
                                        "on",
                                        "with",
                                        "without",
                                        "and",
                                        "not",
                                        "its",
                                        "left",
                                        "two",
                                        "of",
                                        "wooden",
                                        "snow",
                                        "remove",
                                        ",",
                                        ".",
                                        "'s",
                                        "than",
                                        "into",
                                        "like",
                                        "wears",
                                        "is",
                                        "bigger",
                                        "no",
                                        "cat",
                                        "head",
                                        "instead",
                                        "it",
                                        "everything",
                                        "except",
                                        "turn",
                                        "give",
                                        "striped",
                                        "behind",
                                        "that",
                                        "should",
                                        "zzz",
                                        "(",
                                        "]",
                                        ":1.2)",
                                        "\xf0\x9f\x90\xbb",
                                        "\xff"};
    constexpr int Sentences = 1500;
    constexpr int MostWords = 14;
    std::mt19937 random(58);
    for (int i = 0; i < Sentences; ++i) {
        std::string text;
        for (int words = 1 + static_cast<int>(random() % MostWords); words > 0; --words)
            text += soup[random() % soup.size()] + " ";
        DOCTEST_INFO(text);
        const auto made = plan::plan_sentence(text, plan::scene_words("red bear; blue hat; grass"), "bear");
        DOCTEST_REQUIRE(!made.steps.empty());
        DOCTEST_REQUIRE(is_legal(to_string(made)));
        DOCTEST_REQUIRE(to_string(made) == planned(text, "red bear; blue hat; grass"));
        int last = 0;
        std::set<std::string> new_things;
        for (const auto& step : made.steps) {
            const bool of_new = !step.subject.links.empty() && new_things.contains(step.subject.root());
            if (!of_new) {
                DOCTEST_REQUIRE(rank(step.operation) >= last);
                last = rank(step.operation);
            }
            if (step.operation == Operation::Add || step.operation == Operation::Replace)
                new_things.insert(step.thing.noun);
            if (step.operation == Operation::None) DOCTEST_REQUIRE(made.steps.size() == 1);
        }
    }
}

DOCTEST_TEST_CASE("figures are animals, persons and their likenesses; furniture and vehicles are none") {
    for (const char* noun : {"bear", "man", "women", "statue", "bust", "robot", "stone statue", "puppies"})
        DOCTEST_CHECK_MESSAGE(plan::names_figure(noun), noun);
    for (const char* noun : {"chair", "car", "house", "pedestal", "table", "lamp", "", "red"})
        DOCTEST_CHECK_MESSAGE(!plan::names_figure(noun), noun);
}

DOCTEST_TEST_CASE("long texts are read in a time that grows with their length") {
    std::string text;
    for (int i = 0; i < 300; ++i) text += "a bear and ";
    DOCTEST_CHECK(is_legal(planned(text)));
    DOCTEST_CHECK(planned(std::string(10000, 'a')) == "refuse(not a sentence)");
    DOCTEST_CHECK(is_legal(planned(std::string(2000, '('))));
}

DOCTEST_TEST_CASE("the suite of sentences is planned as it was, or better") {
    const auto path = test::shared_folder() / "data/sentences/sentences_dev.tsv";
    if (!test::available(path)) return;
    constexpr int LeastExact = 690;    // of 745; 700 are exactly one of the readings
    constexpr int MostFalseDone = 30;  // plans that do something else than a reading does
    int exact = 0, wrong = 0, count = 0;
    std::ifstream lines(path);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        const auto cells = cells_of(line, "\t");
        const auto made =
            plan::plan_sentence(unescaped(cells.at(3)), plan::scene_words(cells.at(1)), cells.at(2));
        const auto text = to_string(made);
        const auto readings = cells_of(cells.at(4), " | ");
        const bool right = std::find(readings.begin(), readings.end(), text) != readings.end();
        DOCTEST_CHECK(is_legal(text));
        ++count;
        exact += right ? 1 : 0;
        wrong += !right && text.find("refuse(") != 0 ? 1 : 0;
    }
    DOCTEST_CHECK(count == 745);
    DOCTEST_CHECK(exact >= LeastExact);
    DOCTEST_CHECK(wrong <= MostFalseDone);
}

}  // namespace plan_test
