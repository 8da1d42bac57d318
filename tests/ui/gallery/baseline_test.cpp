// The comparison with baselines itself: it forgives what another font or driver does, and nothing that a
// person would call another picture.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/random.h"
#include "tests/image_baseline.h"
#include "tests/ui/support/harness.h"

namespace gse::test::baseline_test {
namespace {

Image window_picture(Situation situation) {
    Harness harness({1280, 720, 1, situation, true});
    harness.frame(6);
    return harness.picture();
}

double share(const Image& a, const Image& b) { return changed_share(a, b, WindowTolerance); }

/// The picture with everything in a rectangle painted in one colour.
Image painted(Image picture, const ui::Rect& area, float level) {
    for (int y = static_cast<int>(area.y); y < static_cast<int>(area.y + area.height); ++y)
        for (int x = static_cast<int>(area.x); x < static_cast<int>(area.x + area.width); ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = level;
    return picture;
}

/// The picture with its columns moved right by `by` pixels.
Image moved(const Image& picture, int by) {
    Image result = picture;
    for (int y = 0; y < picture.height; ++y)
        for (int x = by; x < picture.width; ++x)
            for (int c = 0; c < 3; ++c) result.at(x, y, c) = picture.at(x - by, y, c);
    return result;
}

}  // namespace

DOCTEST_TEST_CASE("a baseline forgives rounding and noise of one step of 8 bits") {
    const Image picture = window_picture(Situation::Scene);
    Image noisy = picture;
    Random random(5);
    for (float& value : noisy.data) value += (static_cast<float>(random.uniform()) - 0.5f) * 2 / 255;
    DOCTEST_CHECK(share(picture, noisy) == 0);
    DOCTEST_CHECK(share(picture, picture) == 0);
}

DOCTEST_TEST_CASE("a baseline sees another state, a moved window and a panel that went") {
    const Image picture = window_picture(Situation::Scene);
    const double allowed = WindowTolerance.share;
    DOCTEST_CHECK(share(picture, window_picture(Situation::ResultWaiting)) > allowed);
    DOCTEST_CHECK(share(picture, window_picture(Situation::Nothing)) > allowed);
    DOCTEST_CHECK(share(picture, moved(picture, 12)) > allowed);
    DOCTEST_CHECK(share(picture, painted(picture, {1000, 100, 200, 100}, 0.5f)) > allowed);
    DOCTEST_CHECK(changed_share(picture, Image(640, 360, 3), WindowTolerance) == 1);
}

DOCTEST_TEST_CASE("means of squares keep the mean of a picture whose sides are no multiples") {
    Image picture(5, 3, 1);
    for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<float>(i);
    const Image squares = squares_of(picture, 2);
    DOCTEST_REQUIRE(squares.width == 3);
    DOCTEST_REQUIRE(squares.height == 2);
    DOCTEST_CHECK(squares.at(0, 0, 0) == (0 + 1 + 5 + 6) / 4.0f);
    DOCTEST_CHECK(squares.at(2, 0, 0) == (4 + 9) / 2.0f);
    DOCTEST_CHECK(squares.at(2, 1, 0) == 14);
}

}  // namespace gse::test::baseline_test
