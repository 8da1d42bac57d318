// Characters that the panels' fonts lack are painted from the system's.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <numeric>

#include "ui/model/foreign_fonts.h"

namespace foreign_fonts_test {

DOCTEST_TEST_CASE("a character that some font has is painted at its size, one that none has is not") {
    gse::ui::ForeignFonts fonts;
    for (const float size_px : {13.0f, 15.0f, 30.0f}) {
        const auto face = fonts.paint(0x1F600, size_px);  // DejaVu Sans has it
        DOCTEST_REQUIRE(face.has_value());
        DOCTEST_CHECK(face->rgba.size() == static_cast<std::size_t>(face->width * face->height * 4));
        DOCTEST_CHECK(static_cast<float>(face->height) > 0.5f * size_px);
        DOCTEST_CHECK(static_cast<float>(face->height) < 1.5f * size_px);
        DOCTEST_CHECK(face->advance > 0.5f * size_px);
        const long ink = std::accumulate(face->rgba.begin(), face->rgba.end(), 0L);
        DOCTEST_CHECK(ink > 1000);
    }
    DOCTEST_CHECK_FALSE(fonts.paint(0x10FFF0, 15).has_value());
    const auto space = fonts.paint(0x2003, 15);  // an em wide, nothing to be seen
    DOCTEST_CHECK((!space.has_value() || (space->width == 0 && space->advance > 5)));
}

}  // namespace foreign_fonts_test
