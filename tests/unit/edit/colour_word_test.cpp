// A colour for what the sentence leaves open.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "engine/edit/interfaces/model_traits.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"

namespace colour_word_test {

namespace {

using namespace gse;

/// Left half of one colour in light and shade, right half of another.
Image halves(std::array<float, 3> left, std::array<float, 3> right) {
    constexpr int Side = 16;
    Image image(Side, Side, 3);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x)
            for (int c = 0; c < 3; ++c) {
                const float shade = 0.6f + 0.4f * static_cast<float>(y) / Side;
                image.at(x, y, c) = shade * (x < Side / 2 ? left : right)[static_cast<std::size_t>(c)];
            }
    return image;
}

Image share_of(int from, int to) {
    Image share(16, 16, 1);
    for (int y = 0; y < 16; ++y)
        for (int x = from; x < to; ++x) share.at(x, y, 0) = 1;
    return share;
}

}  // namespace

DOCTEST_TEST_CASE("the colour of what is inside the outline, in light and shade") {
    const std::vector<std::pair<const char*, std::array<float, 3>>> samples{
        {"red", {0.85f, 0.07f, 0.07f}},   {"blue", {0.10f, 0.22f, 0.88f}},  {"green", {0.1f, 0.6f, 0.15f}},
        {"yellow", {0.95f, 0.85f, 0.1f}}, {"purple", {0.55f, 0.15f, 0.7f}}, {"orange", {0.95f, 0.5f, 0.05f}},
        {"black", {0.06f, 0.06f, 0.07f}}, {"white", {0.95f, 0.95f, 0.95f}},
    };
    std::vector<std::string> known;
    for (const auto& sample : samples) known.emplace_back(sample.first);
    for (const auto& sample : samples) {
        const std::string word = sample.first;
        DOCTEST_CAPTURE(word);
        const auto image = halves(sample.second, {0.3f, 0.7f, 0.2f});
        DOCTEST_CHECK(edit::colour_shown(image, share_of(0, 8), known) == word);
        DOCTEST_CHECK(edit::colour_shown(image, share_of(8, 16), known) == "green");
    }
    const auto grey = halves({0.5f, 0.5f, 0.5f}, {0, 0, 0});
    DOCTEST_CHECK(edit::colour_shown(grey, share_of(0, 8), {}) == "grey");  // a model that takes any word
    DOCTEST_CHECK(edit::colour_shown(grey, share_of(0, 0), {}).empty());    // no outline
    const auto shaded =
        halves({0.55f, 0.55f, 0.57f},
               {0.12f, 0.12f, 0.13f});  // wings from their darker side, and a hat from its lighter one
    DOCTEST_CHECK(edit::colour_shown(shaded, share_of(0, 8), known) == "white");
    DOCTEST_CHECK(edit::colour_shown(shaded, share_of(8, 16), known) == "black");
    DOCTEST_CHECK(edit::colour_shown(grey, share_of(0, 8), {"bear", "hat"}).empty());
}

DOCTEST_TEST_CASE("light and shade do not divide the votes for a thing without a hue") {
    const std::vector<std::string> known{"orange", "black", "white"};
    edit::ColourVote vote(known);
    const auto lit = halves({0.1f, 0.1f, 0.1f}, {0.7f, 0.7f, 0.7f}),
               behind = halves({0.95f, 0.5f, 0.05f}, {0.95f, 0.5f, 0.05f});
    vote.add(lit, share_of(0, 13));  // 128 dark pixels and 80 light ones
    vote.add(behind,
             share_of(0, 10));  // 160 of the vase that it sits on: more than dark ones, and fewer than both
    DOCTEST_CHECK(vote.winner() == "black");
    vote.add(behind, share_of(0, 10));
    DOCTEST_CHECK(vote.winner() == "orange");
    DOCTEST_CHECK(edit::ColourVote(known).winner().empty());
}

DOCTEST_TEST_CASE("a thing is described by the words beside it only") {
    DOCTEST_CHECK_FALSE(language::is_described("a bear with wings on the grass", "wings"));
    DOCTEST_CHECK_FALSE(language::is_described("a red bear wearing a hat", "hat"));
    DOCTEST_CHECK_FALSE(language::is_described("cat", "cat"));
    DOCTEST_CHECK(language::is_described("a bear with white wings", "wings"));
    DOCTEST_CHECK(language::is_described("a bear wearing a straw hat", "hat"));
    DOCTEST_CHECK(language::is_described("a bear with wings of gold", "wings"));
    DOCTEST_CHECK(language::is_described("a bear with a hat made of wood", "hat"));
    DOCTEST_CHECK(
        language::is_described("a bear in flames on the grass", "flames"));  // a state has its own colour
    DOCTEST_CHECK(language::is_described("a bear on fire", "fire"));
    DOCTEST_CHECK(language::is_described("a bear on the grass", "hat"));  // nothing to describe
}

DOCTEST_TEST_CASE("the colour stands before the thing, and the article follows it") {
    DOCTEST_CHECK(language::described_as("a bear with wings on the grass", "wings", "white") ==
                  "a bear with white wings on the grass");
    DOCTEST_CHECK(language::described_as("a bear wearing a hat", "hat", "orange") ==
                  "a bear wearing an orange hat");
    DOCTEST_CHECK(language::described_as("an owl on the sand", "owl", "red") == "a red owl on the sand");
    DOCTEST_CHECK(language::described_as("a bear with a top hat", "top hat", "black") ==
                  "a bear with a black top hat");
    DOCTEST_CHECK(language::described_as("the cat", "cat", "") == "the cat");
}

DOCTEST_TEST_CASE("a thing that comes has its usual colour where the sentence tells none") {
    const auto usual = edit::ModelTraits{}.usual_colours;
    const std::vector<std::string> sayable{"white", "green", "red", "frog", "owl"};
    DOCTEST_CHECK(language::with_usual_colour("a frog on the grass", "frog", sayable, usual) ==
                  "a green frog on the grass");
    DOCTEST_CHECK(language::with_usual_colour("a red frog", "frog", sayable, usual) == "a red frog");
    // "big" says nothing to the model.
    DOCTEST_CHECK(language::with_usual_colour("a big frog", "frog", sayable, usual) == "a big green frog");
    DOCTEST_CHECK(language::with_usual_colour("a frog made of wood", "frog", sayable, usual) ==
                  "a frog made of wood");
    DOCTEST_CHECK(language::with_usual_colour("a cat", "cat", sayable, usual) == "a cat");
    DOCTEST_CHECK(language::with_usual_colour("a bear with wings", "wings",
                                              {"a", "bear", "with", "wings", "white"},
                                              usual) == "a bear with white wings");
    // Brown cannot be said.
    DOCTEST_CHECK(language::with_usual_colour("an owl", "owl", sayable, usual) == "an owl");
    // A model of all words.
    DOCTEST_CHECK(language::with_usual_colour("a frog", "frog", {}, usual) == "a frog");
}

}  // namespace colour_word_test
