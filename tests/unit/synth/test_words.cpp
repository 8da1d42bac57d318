// Captions, groundings, random specifications and edit sentences.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/laboratory/synth/synth.h"

namespace test_words {

using namespace gse;
using namespace gse::synth;

namespace {

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> words(1);
    for (const char letter : text) {
        if (letter == ' ') words.emplace_back();
        else if (letter != ',') words.back() += letter;
    }
    return words;
}

bool in(const std::vector<std::string>& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

bool equal(const SceneSpec& a, const SceneSpec& b) {
    return a.object == b.object && a.material == b.material && a.accessory == b.accessory &&
           a.accessory_colour == b.accessory_colour && a.ground == b.ground && a.seed == b.seed &&
           a.gaussian_budget == b.gaussian_budget;
}

void check_caption(const Caption& caption) {
    DOCTEST_CAPTURE(caption.text);
    const auto words = split(caption.text);
    for (const auto& word : words) {
        DOCTEST_CAPTURE(word);
        DOCTEST_CHECK(in(vocabulary(), word));
    }
    DOCTEST_CHECK_FALSE(caption.groundings.empty());
    std::set<std::pair<std::string, int>> seen;
    for (const auto& grounding : caption.groundings) {
        DOCTEST_CAPTURE(grounding.word);
        DOCTEST_CHECK(grounding.occurrence >= 0);
        DOCTEST_CHECK(std::count(words.begin(), words.end(), grounding.word) > grounding.occurrence);
        DOCTEST_CHECK(seen.emplace(grounding.word, grounding.occurrence).second);
    }
}

}  // namespace

DOCTEST_TEST_CASE("the vocabulary is small, lower case and without doubles") {
    std::set<std::string> unique;
    for (const auto& word : vocabulary()) {
        DOCTEST_CHECK(unique.insert(word).second);
        DOCTEST_CHECK(std::all_of(word.begin(), word.end(), [](char c) { return c >= 'a' && c <= 'z'; }));
    }
    DOCTEST_CHECK(vocabulary().size() < 90);
    for (const auto& list : {object_words(), material_words(), accessory_words(), ground_words()})
        for (const auto& word : list) DOCTEST_CHECK(in(vocabulary(), word));
}

DOCTEST_TEST_CASE("full captions say everything and ground every word") {
    const Caption caption = full_caption({.object = "bear",
                                          .material = "orange",
                                          .accessory = "hat",
                                          .accessory_colour = "blue",
                                          .ground = "grass"});
    DOCTEST_CHECK(caption.text == "an orange bear wearing a blue hat on the grass");
    std::map<std::string, Part> parts;
    for (const auto& grounding : caption.groundings) parts[grounding.word] = grounding.part;
    DOCTEST_CHECK(parts == std::map<std::string, Part>{{"orange", Part::Object},
                                                       {"bear", Part::Object},
                                                       {"blue", Part::Accessory},
                                                       {"hat", Part::Accessory},
                                                       {"grass", Part::Ground}});
    DOCTEST_CHECK(
        full_caption({.object = "dog", .material = "black", .accessory = "sunglasses", .ground = "sand"})
            .text == "a black dog wearing sunglasses on the sand");
    DOCTEST_CHECK(
        full_caption({.object = "car", .material = "stone", .accessory = "flames", .ground = "snow"}).text ==
        "a stone car in flames on the snow");
}

DOCTEST_TEST_CASE("a word that names two parts is told apart by its occurrence") {
    const Caption caption = full_caption({.object = "cat",
                                          .material = "red",
                                          .accessory = "scarf",
                                          .accessory_colour = "red",
                                          .ground = "snow"});
    std::map<int, Part> reds;
    for (const auto& grounding : caption.groundings)
        if (grounding.word == "red") reds[grounding.occurrence] = grounding.part;
    DOCTEST_CHECK(reds == std::map<int, Part>{{0, Part::Object}, {1, Part::Accessory}});
}

DOCTEST_TEST_CASE("random captions stay in the vocabulary, vary, and drop words as often as said") {
    Random random(11);
    std::set<std::string> texts, used;
    int with_view = 0, with_object = 0;
    constexpr int Count = 4000;
    for (int i = 0; i < Count; ++i) {
        const SceneSpec spec = random_spec(random, 0.6);
        const Caption caption = random_caption(spec, random.uniform(-4, 4), random);
        check_caption(caption);
        texts.insert(caption.text);
        const auto words = split(caption.text);
        used.insert(words.begin(), words.end());
        with_view += in(words, "view") ? 1 : 0;
        with_object += in(words, spec.object) ? 1 : 0;
    }
    DOCTEST_CHECK(texts.size() > Count / 2);
    DOCTEST_CHECK(with_view > Count * 0.60);
    DOCTEST_CHECK(with_view < Count * 0.70);
    DOCTEST_CHECK(with_object > Count * 0.9);
    for (const auto& list : {object_words(), material_words(), accessory_words(), ground_words()})
        for (const auto& word : list) DOCTEST_CHECK(used.count(word) == 1);
}

DOCTEST_TEST_CASE("random captions repeat for the same random stream") {
    Random a(5), b(5);
    for (int i = 0; i < 50; ++i) {
        const SceneSpec spec = random_spec(a);
        DOCTEST_CHECK(equal(spec, random_spec(b)));
        DOCTEST_CHECK(random_caption(spec, 0.5, a).text == random_caption(spec, 0.5, b).text);
    }
}

DOCTEST_TEST_CASE("views have three names") {
    DOCTEST_CHECK(view_words(0) == "front view");
    DOCTEST_CHECK(view_words(0.5) == "front view");
    DOCTEST_CHECK(view_words(-1.5) == "side view");
    DOCTEST_CHECK(view_words(1.5) == "side view");
    DOCTEST_CHECK(view_words(3.0) == "back view");
    DOCTEST_CHECK(view_words(-3.0) == "back view");
    DOCTEST_CHECK(view_words(6.2) == "front view");
}

DOCTEST_TEST_CASE("with left and right, views have eight names, of words of the vocabulary") {
    std::set<std::string> names;
    for (double azimuth = -7; azimuth < 7; azimuth += 0.1) names.insert(sided_view_words(azimuth));
    DOCTEST_CHECK_EQ(names.size(), 8);
    for (const auto& name : names)
        for (const auto& word : split(name))
            DOCTEST_CHECK(std::find(vocabulary().begin(), vocabulary().end(), word) != vocabulary().end());
}

DOCTEST_TEST_CASE("about a tenth of the combinations is held out, and training never sees them") {
    int held = 0, all = 0;
    auto accessories = accessory_words();
    accessories.emplace_back();
    for (const auto& object : object_words())
        for (const auto& material : material_words())
            for (const auto& accessory : accessories) {
                ++all;
                held += held_out({.object = object, .material = material, .accessory = accessory}) ? 1 : 0;
            }
    DOCTEST_CHECK(held > 0.06 * all);
    DOCTEST_CHECK(held < 0.14 * all);
    SceneSpec spec{.object = "dog", .material = "blue", .accessory = "crown"};
    const bool before = held_out(spec);
    spec.seed = 99;
    spec.ground = "sand";
    spec.accessory_colour = "red";
    DOCTEST_CHECK(held_out(spec) == before);
    Random random(3);
    std::map<std::string, int> accessory_count;
    for (int i = 0; i < 2000; ++i) {
        const SceneSpec training = training_spec(random, 0.5);
        DOCTEST_CHECK_FALSE(held_out(training));
        ++accessory_count[training.accessory];
        if (i % 20 == 0) DOCTEST_CHECK(held_out(held_out_spec(random, 0.5)));
    }
    DOCTEST_CHECK(accessory_count.at("") > 850);
    DOCTEST_CHECK(accessory_count.at("") < 1150);
    for (const auto& accessory : accessory_words()) DOCTEST_CHECK(accessory_count[accessory] > 70);
}

DOCTEST_TEST_CASE("edit sentences change what they name and nothing else") {
    const SceneSpec bear{.object = "bear", .material = "red", .ground = "grass", .seed = 42};
    SceneSpec hatted = bear;
    hatted.accessory = "hat";
    hatted.accessory_colour = "blue";
    const auto expect = [](const SceneSpec& from, const char* sentence, auto&& change) {
        DOCTEST_CAPTURE(std::string(sentence));
        SceneSpec wanted = from;
        change(wanted);
        DOCTEST_CHECK(equal(apply_edit(from, sentence), wanted));
    };
    expect(bear, "a blue bear", [](SceneSpec& s) { s.material = "blue"; });
    expect(bear, "A Blue Bear.", [](SceneSpec& s) { s.material = "blue"; });
    expect(bear, "a golden statue", [](SceneSpec& s) { s.material = "golden", s.object = "statue"; });
    expect(bear, "a bear wearing a green hat",
           [](SceneSpec& s) { s.accessory = "hat", s.accessory_colour = "green"; });
    expect(bear, "a blue bear wearing a red crown on the sand", [](SceneSpec& s) {
        s.material = "blue", s.accessory = "crown", s.accessory_colour = "red", s.ground = "sand";
    });
    expect(bear, "turn the bear into a wooden bear", [](SceneSpec& s) { s.material = "wooden"; });
    expect(bear, "turn the red bear into a black dog",
           [](SceneSpec& s) { s.object = "dog", s.material = "black"; });
    expect(bear, "a bear made of stone", [](SceneSpec& s) { s.material = "stone"; });
    expect(bear, "a bear made of gold on the snow",
           [](SceneSpec& s) { s.material = "golden", s.ground = "snow"; });
    expect(bear, "make it black and add a red scarf",
           [](SceneSpec& s) { s.material = "black", s.accessory = "scarf", s.accessory_colour = "red"; });
    expect(bear, "a bear on green grass", [](SceneSpec&) {});
    expect(bear, "make it purple", [](SceneSpec& s) { s.material = "purple"; });
    expect(bear, "a bear on fire", [](SceneSpec& s) { s.accessory = "flames"; });
    expect(bear, "a bear with glasses", [](SceneSpec& s) { s.accessory = "sunglasses"; });
    expect(hatted, "a bear wearing a hat", [](SceneSpec&) {});
    expect(hatted, "a red hat", [](SceneSpec& s) { s.accessory_colour = "red"; });
    expect(hatted, "make the hat white", [](SceneSpec& s) { s.accessory_colour = "white"; });
    expect(hatted, "a bear wearing a crown",
           [](SceneSpec& s) { s.accessory = "crown", s.accessory_colour = ""; });
    expect(hatted, "remove the hat", [](SceneSpec& s) { s.accessory = s.accessory_colour = ""; });
    expect(hatted, "a green bear without a hat", [](SceneSpec& s) {
        s.material = "green";
        s.accessory = s.accessory_colour = "";
    });
    expect(bear, "a pink rabbit on the leaves",
           [](SceneSpec& s) { s.object = "rabbit", s.material = "pink", s.ground = "leaves"; });
    expect(bear, "a bear with golden horns",
           [](SceneSpec& s) { s.accessory = "horns", s.accessory_colour = "golden"; });
    expect(hatted, "a red bear on the tiled floor", [](SceneSpec& s) { s.ground = "tiles"; });
}

DOCTEST_TEST_CASE("captions are edit sentences that lead to their own scene") {
    Random random(8);
    for (int i = 0; i < 300; ++i) {
        const SceneSpec target = random_spec(random, 0.6);
        SceneSpec from{.object = "ball", .material = "white", .ground = "sand", .seed = target.seed};
        DOCTEST_CAPTURE(full_caption(target).text);
        DOCTEST_CHECK(equal(apply_edit(from, full_caption(target).text), target));
    }
}

DOCTEST_TEST_CASE("a sentence without a known word is an error") {
    DOCTEST_CHECK_THROWS_AS(apply_edit({}, "a shiny unicorn"), Error);
    DOCTEST_CHECK_THROWS_AS(apply_edit({}, ""), Error);
    DOCTEST_CHECK_THROWS_AS(apply_edit({}, "turn it into a"), Error);
}

}  // namespace test_words
