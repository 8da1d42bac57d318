// Characters beyond the fonts: which are asked for, how they go through ImGui and back, and that they get
// pictures.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/model/glyphs.h"
#include "ui/model/theme.h"

namespace gse::test::glyphs_test {
namespace {

// bär, the Chinese bear, the emoji bear.
constexpr const char* Mixed = "b\xC3\xA4r \xE7\x86\x8A \xF0\x9F\x90\xBB";

std::optional<ui::PaintedGlyph> square(char32_t, float size_px) {
    ui::PaintedGlyph glyph;
    glyph.width = glyph.height = static_cast<int>(size_px) - 2;
    glyph.top = size_px - 4;
    glyph.advance = size_px;
    glyph.coloured = true;
    glyph.rgba.assign(static_cast<std::size_t>(glyph.width * glyph.height) * 4, 200);
    return glyph;
}

}  // namespace

DOCTEST_TEST_CASE("what does not fit into 16 bits comes back as it was") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    ui::ForeignGlyphs glyphs;
    const std::string shown = glyphs.shown(Mixed);
    DOCTEST_CHECK(shown != Mixed);
    DOCTEST_CHECK(glyphs.meant(shown) == Mixed);
    DOCTEST_CHECK(glyphs.shown(Mixed) == shown);
    DOCTEST_CHECK(glyphs.shown("plain") == "plain");
    DOCTEST_CHECK(
        glyphs.meant(glyphs.shown("\xFF\xC0 x")).ends_with(" x"));  // no UTF-8: nothing is read beyond it
}

DOCTEST_TEST_CASE("texts that are shown ask for what the fonts lack, once, and then have it") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    DOCTEST_CHECK(harness.shell.glyphs().all().empty());
    harness.application.model().toasts[0].text = Mixed;
    harness.frame(3);
    const auto wanted = harness.shell.glyphs().all();
    DOCTEST_REQUIRE(wanted.size() == 2);
    DOCTEST_CHECK(wanted[0].first == 0x718A);
    DOCTEST_CHECK(wanted[1].first == 0x1F43B);
    auto& atlas = *ImGui::GetIO().Fonts;
    ui::dress(atlas, ImGui::GetStyle(), 1, harness.shell.glyphs(), square);
    for (const ImFont* font : atlas.Fonts)
        for (const auto& [character, code] : wanted) {
            const ImFontGlyph* glyph = font->FindGlyphNoFallback(code);
            DOCTEST_REQUIRE(glyph != nullptr);
            DOCTEST_CHECK(glyph->Colored == 1);
            DOCTEST_CHECK(glyph->Visible == 1);
        }
    harness.frame(3);
    DOCTEST_CHECK(harness.shell.glyphs().all().size() == 2);
}

DOCTEST_TEST_CASE("a prompt with an emoji keeps it while it is edited") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.application.model().request.prompt = Mixed;
    harness.frame(2);
    harness.click("prompt.sentence");
    harness.key(269);  // End
    harness.type("!");
    DOCTEST_CHECK(harness.application.model().request.prompt == std::string(Mixed) + "!");
}

}  // namespace gse::test::glyphs_test
