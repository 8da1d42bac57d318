// Places of clicks in the picture that SAM's encoder sees.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/neural/sam/sam_model.h"

using namespace gse::neural;

DOCTEST_TEST_CASE("clicks are scaled along each side by what that side was rounded to") {
    // 50 x 128 / 75 = 85.3 pixels are 85 (segment-anything, ResizeLongestSide.apply_coords).
    const auto wide = sam_scale(128, 50, 75), high = sam_scale(128, 75, 50);
    DOCTEST_CHECK(wide.x == doctest::Approx(128.0 / 75).epsilon(1e-12));
    DOCTEST_CHECK(wide.y == doctest::Approx(85.0 / 50).epsilon(1e-12));
    DOCTEST_CHECK(high.x == doctest::Approx(85.0 / 50).epsilon(1e-12));
    DOCTEST_CHECK(high.y == doctest::Approx(128.0 / 75).epsilon(1e-12));
    const auto even = sam_scale(128, 32, 64);
    DOCTEST_CHECK((even.x == 2 && even.y == 2));
}
