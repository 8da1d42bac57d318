// Pictures for drawing new things: several of one scene, each with its camera.
#include <doctest/doctest.h>

#include <numbers>
#include <set>

#include "engine/training/starter_source.h"

namespace {

constexpr int Size = 32;

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
