// Pictures for drawing new things: several of one scene, each with its camera.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "engine/laboratory/starter/split_caption.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/laboratory/training/starter_source.h"

namespace shape_source_test {

namespace {

constexpr int Size = 32;

/// Tells whether one of the words, or one that means the same, is in the text.
bool says_one(const std::string& text, std::vector<std::string> words,
              const std::vector<std::string>& synonyms) {
    words.insert(words.end(), synonyms.begin(), synonyms.end());
    const auto spaced = ' ' + text.substr(0, text.find(',')) + ' ';
    return std::any_of(words.begin(), words.end(),
                       [&](const auto& word) { return spaced.find(' ' + word + ' ') != std::string::npos; });
}

std::string without_side(const std::string& text) { return text.substr(0, text.rfind(", ")); }

}  // namespace

DOCTEST_TEST_CASE("views of one scene differ in their side only") {
    const auto source = gse::training::make_shape_source(3);
    const auto views = static_cast<std::uint64_t>(source->views_of_scene());
    DOCTEST_REQUIRE(views > 1);
    std::size_t told = 0;
    std::set<double> azimuths;
    for (std::uint64_t scene = 0; scene < 20; ++scene) {
        const auto first = source->caption(scene * views, scene, false);
        for (std::uint64_t v = 0; v < views; ++v) {
            const auto caption = source->caption(scene * views + v, scene, false);
            const auto camera = source->camera(scene * views + v);
            azimuths.insert(camera.azimuth);
            DOCTEST_CHECK(std::abs(camera.azimuth) <= std::numbers::pi);
            DOCTEST_CHECK(camera.elevation > 0);
            DOCTEST_CHECK(caption.next_text.empty() == first.next_text.empty());
            if (caption.next_text.empty()) continue;
            told += 1;
            DOCTEST_CHECK(without_side(caption.text) == without_side(first.text));
            DOCTEST_CHECK(without_side(caption.next_text) == without_side(first.text));
        }
    }
    DOCTEST_CHECK(told > 10 * views);
    DOCTEST_CHECK(azimuths.size() == 20 * views);
}

DOCTEST_TEST_CASE("a picture of a scene does not depend on which was asked for before") {
    const auto source = gse::training::make_shape_source(4), other = gse::training::make_shape_source(5);
    const auto views = static_cast<std::uint64_t>(source->views_of_scene());
    const auto picture = source->picture(1, Size).rgb;
    DOCTEST_CHECK(source->picture(0, Size).rgb != picture);
    source->picture(views + 1, Size);
    DOCTEST_CHECK(source->picture(1, Size).rgb == picture);
    DOCTEST_CHECK(other->picture(1, Size).rgb != picture);
    DOCTEST_CHECK(source->picture(1, Size).rgb == picture);
}

DOCTEST_TEST_CASE(
    "a view of before lacks what the caption's edit brings, and nothing else where that is something worn") {
    const auto source = gse::training::make_shape_source(6);
    DOCTEST_REQUIRE(source->before() != nullptr);
    DOCTEST_CHECK(source->before()->before() == nullptr);
    DOCTEST_CHECK(source->before()->identity() != source->identity());
    const auto views = static_cast<std::uint64_t>(source->views_of_scene());
    constexpr int Cells = Size / 4;
    std::size_t worn = 0, replaced = 0;
    for (std::uint64_t index = 0; index < 24 * views; index += views + 1) {
        const auto after = source->picture(index, Size), before = source->before()->picture(index, Size);
        DOCTEST_CHECK(before.rgb != after.rgb);
        DOCTEST_CHECK(
            (source->has_outlines() && !source->before()->has_outlines() && before.outline.empty()));
        const std::uint8_t* accessory = &after.coverage[2 * Cells * Cells];
        const bool wears =
            std::any_of(accessory, accessory + Cells * Cells, [](int covered) { return covered > 0; });
        (wears ? worn : replaced) += 1;
        // The outline is the coverage of what is new, pixel by pixel.
        DOCTEST_REQUIRE(after.outline.size() == std::size_t{Size} * Size);
        const double pixels = std::accumulate(after.outline.begin(), after.outline.end(), 0.0) / 16;
        const std::uint8_t* part = &after.coverage[(wears ? 2 : 1) * Cells * Cells];
        DOCTEST_CHECK(std::abs(pixels - std::accumulate(part, part + Cells * Cells, 0.0)) <
                      Cells * Cells);  // a step of rounding each
        if (!wears) continue;
        // Away from what is worn and from its shadow most pixels are the same.
        std::size_t same = 0;
        for (std::size_t i = 0; i < after.rgb.size(); ++i) same += after.rgb[i] == before.rgb[i];
        DOCTEST_CHECK(same > after.rgb.size() / 4);
    }
    DOCTEST_CHECK(worn > 3);
    DOCTEST_CHECK(replaced > 3);
}

DOCTEST_TEST_CASE(
    "what is restyled looked different before, where it is and nowhere else, and the caption tells its "
    "look") {
    const auto source = gse::training::make_shape_source(6, {.restyled = 1}),
               plain = gse::training::make_shape_source(6);
    const auto views = static_cast<std::uint64_t>(source->views_of_scene());
    DOCTEST_CHECK_FALSE(plain->restyled(0).has_value());
    DOCTEST_CHECK(source->identity() != plain->identity());
    std::set<gse::training::StarterPart> parts;
    for (std::uint64_t scene = 0; scene < 24; ++scene) {
        const std::uint64_t index = scene * views + scene % views;
        const auto part = source->restyled(index);
        DOCTEST_REQUIRE((part.has_value() && source->before()->restyled(index) == part));
        parts.insert(*part);
        const auto after = source->picture(index, Size), before = source->before()->picture(index, Size);
        constexpr std::size_t Cells = Size / 4;
        double changed = 0, elsewhere = 0;
        for (std::size_t cell = 0; cell < Cells * Cells; ++cell) {
            const double covered =
                after.coverage[static_cast<std::size_t>(*part) * Cells * Cells + cell] / 255.0;
            double difference = 0;
            for (std::size_t k = 0; k < 16; ++k)
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t at =
                        ((cell / Cells * 4 + k / 4) * Size + cell % Cells * 4 + k % 4) * 3 + c;
                    difference += std::abs(after.rgb[at] - before.rgb[at]) / 48.0;
                }
            if (covered > 0.9) changed = std::max(changed, difference);
            if (covered == 0) elsewhere = std::max(elsewhere, difference);
        }
        // Another look changes colours only: where nothing of the part is, both pictures are the same. A cell
        // whose coverage is rounded to 0 may hold half a step of it, and pixels are rounded, too.
        constexpr double Rounding = 0.5 + 0.5;
        DOCTEST_CHECK(elsewhere < Rounding);
        const double most_covered = *std::max_element(
            after.coverage.begin() +
                static_cast<std::ptrdiff_t>(static_cast<std::size_t>(*part) * Cells * Cells),
            after.coverage.begin() +
                static_cast<std::ptrdiff_t>((static_cast<std::size_t>(*part) + 1) * Cells * Cells));
        if (most_covered > 0.95 * 255) DOCTEST_CHECK(changed > 4);
        // A picture's caption tells the look, however it is put.
        for (std::uint64_t wording = 0; wording < 8; ++wording) {
            const auto text = source->caption(index, wording, false).text;
            DOCTEST_CAPTURE(text);
            if (*part == gse::training::StarterPart::Object)
                DOCTEST_CHECK(says_one(text, gse::synth::material_words(), {"wood", "gold"}));
            if (*part == gse::training::StarterPart::Ground)
                DOCTEST_CHECK(says_one(text, gse::synth::ground_words(), {"tiled", "lake"}));
        }
        // There is no room: nothing of another shape was there.
        DOCTEST_CHECK(std::all_of(before.coverage.begin() + Cells * Cells,
                                  before.coverage.begin() + 2 * Cells * Cells,
                                  [](int room) { return room == 0; }));
    }
    DOCTEST_CHECK(parts.size() == 3);
    // Another source of the same seed, asked in between, changes nothing.
    const auto alone = plain->before()->picture(0, Size).rgb;
    plain->before()->picture(views, Size);  // of another scene: nothing of the first is known
    source->before()->picture(0, Size);
    DOCTEST_CHECK(plain->before()->picture(0, Size).rgb == alone);
}

DOCTEST_TEST_CASE("further words are in as many scenes as asked for, and in the vocabulary") {
    const auto source = gse::training::make_shape_source(8, {.restyled = 0.3, .more = 0.5}),
               looks = gse::training::make_shape_source(8, {.more = 1, .more_looks = true});
    const auto views = static_cast<std::uint64_t>(source->views_of_scene());
    const auto& known = gse::synth::vocabulary();
    const auto vocabulary = source->vocabulary();
    const auto has = [](const std::vector<std::string>& words, const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    constexpr std::uint64_t Scenes = 200;
    std::size_t further = 0, grey = 0;
    for (std::uint64_t scene = 0; scene < Scenes; ++scene)
        for (const auto* from : {source.get(), looks.get()}) {
            bool is_further = false;
            for (std::uint64_t wording = 0; wording < 4; ++wording)
                for (const auto& word :
                     gse::training::split_caption(from->caption(scene * views, wording, false).text)) {
                    if (word == ",") continue;
                    DOCTEST_CHECK(has(vocabulary, word));
                    is_further = is_further || !has(known, word);
                    grey += word == "grey" ? 1 : 0;
                    if (from == looks.get()) DOCTEST_CHECK_FALSE(has(gse::synth::more_object_words(), word));
                }
            further += is_further && from == source.get() ? 1 : 0;
        }
    DOCTEST_CHECK(further > 0.35 * Scenes);  // some captions leave the word out
    DOCTEST_CHECK(further < 0.6 * Scenes);
    DOCTEST_CHECK(grey > 0);
    DOCTEST_CHECK(gse::training::make_shape_source(8)->vocabulary() == known);
}

}  // namespace shape_source_test
