// Grounds in the colour that they have everywhere.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "engine/edit/target_views/strategies/default_ground_colour.h"

namespace default_ground_colour_test {

using namespace gse;
using Rgb = std::array<float, 3>;

constexpr double Rounding = 1e-5;  // of a few float operations on values up to 1

std::optional<Rgb> look(const char* prompt, const char* target,
                        edit::EditMode mode = edit::EditMode::Modify) {
    return edit::default_ground_colour({language::Sentence(prompt), "grass", target}, mode,
                                       edit::ModelTraits{});
}

/// A grey ramp of 8x8, times `light`; its lower half may change.
edit::EditView ramp(float light) {
    edit::EditView view;
    view.original = Image(8, 8, 3);
    view.mask = Mask(8, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            for (int c = 0; c < 3; ++c)
                view.original.at(x, y, c) = light * (0.3f + 0.05f * static_cast<float>(x));
            view.mask.at(x, y) = y >= 4 ? 1 : 0;
        }
    view.rendered = view.original;
    return view;
}

DOCTEST_TEST_CASE("grounds have a usual look, unless the sentence says what they are like") {
    DOCTEST_CHECK(look("a bear on the snow", "snow"));
    DOCTEST_CHECK_FALSE(look("a bear on the red sand", "sand"));
    DOCTEST_CHECK_FALSE(look("a bear on the tiles", "tiles"));  // of any colour
    DOCTEST_CHECK_FALSE(look("a golden bear on the grass", "golden"));
    DOCTEST_CHECK_FALSE(look("a bear on the snow", "snow", edit::EditMode::Add));
}

DOCTEST_TEST_CASE(
    "what may change gets the colour in the light in which it was, however dark a scan is, and nothing else "
    "changes") {
    const auto snow = *look("a bear on the snow", "snow");
    edit::DefaultGroundColour views(snow);
    DOCTEST_CHECK(views.supports_appearance_editing());
    const auto bright = views.edit({ramp(1), ramp(1)}, {}, {}),
               dark = views.edit({ramp(0.2f), ramp(0.2f)}, {}, {});
    DOCTEST_REQUIRE(bright.images.size() == 2);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int c = 0; c < 3; ++c) {
                const float value = bright.images[1].at(x, y, c);
                if (y < 4) {
                    DOCTEST_CHECK(value == ramp(1).original.at(x, y, c));
                    continue;
                }
                DOCTEST_CHECK(std::abs(value - dark.images[1].at(x, y, c)) < Rounding);
                DOCTEST_CHECK(value > 0.5f * snow[static_cast<std::size_t>(c)]);
                if (x > 0) DOCTEST_CHECK(value >= bright.images[1].at(x - 1, y, c));  // light stays light
            }
    const auto black = views.edit({ramp(0)}, {}, {});
    for (const float value : black.images[0].data) DOCTEST_CHECK(std::isfinite(value));
}

DOCTEST_TEST_CASE("how far pictures went towards a colour") {
    const Rgb white{0.9f, 0.9f, 0.9f};
    const auto gone = [&](float before, float after, bool dropped = false) {
        edit::ViewTarget view;
        auto first = std::make_shared<Image>(4, 4, 3), second = std::make_shared<Image>(4, 4, 3);
        for (std::size_t i = 0; i < 24; ++i)
            first->data[i] = before, second->data[i] = after;  // half of the picture
        view.before = first, view.after = second, view.dropped = dropped;
        edit::ViewTargets round;
        round.views = {view};
        return edit::gone_towards(white, round);
    };
    DOCTEST_CHECK(gone(0.1f, 0.9f) == doctest::Approx(1));
    DOCTEST_CHECK(gone(0.1f, 0.5f) == doctest::Approx(0.5));
    DOCTEST_CHECK(gone(0.5f, 0.1f) == doctest::Approx(-1));
    DOCTEST_CHECK(gone(0.1f, 0.1f) == 0);  // nothing came
    DOCTEST_CHECK(gone(0.1f, 0.9f, true) == 0);
    DOCTEST_CHECK(gone(0.86f, 0.8f) == 1);  // it began there
}

}  // namespace default_ground_colour_test
