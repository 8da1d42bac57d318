// Looks: words and their tones, and redrawn views that are brought to them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "engine/edit/target_views/strategies/look_correction.h"

namespace look_test {

namespace {

using namespace gse;
using Rgb = std::array<float, 3>;

constexpr int Side = 32;

/// Pictures of the unedited thing, whatever is asked: a model that changes nothing; or others.
struct Drawn final : edit::MultiViewEditor {
    std::vector<Image> pictures;  // empty = as the views are
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest&,
                           const JobControl&) override {
        edit::EditedViews result;
        for (const auto& view : views) result.images.push_back(view.rendered);
        if (!pictures.empty()) result.images = pictures;
        return result;
    }
};

/// A disc on black: its left half of one colour and its right half of another, each darker towards the foot.
edit::EditView disc(const Rgb& left, const Rgb& right) {
    edit::EditView view;
    view.mask = Mask(Side, Side);
    view.rendered = Image(Side, Side, 3);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x) {
            if ((x - 16) * (x - 16) + (y - 16) * (y - 16) > 14 * 14) continue;
            view.mask.at(x, y) = 1;
            const float light = 1 - 0.6f * static_cast<float>(y) / Side;
            for (int c = 0; c < 3; ++c)
                view.rendered.at(x, y, c) = light * (x < 16 ? left : right)[static_cast<std::size_t>(c)];
        }
    view.original = view.rendered;
    return view;
}

constexpr Rgb Green{0.1f, 0.6f, 0.15f}, Blue{0.1f, 0.2f, 0.6f}, Bronze{0.35f, 0.4f, 0.55f};

Rgb at(const Image& picture, int x, int y) {
    return {picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)};
}

Image corrected(const char* word, const edit::EditView& view, Drawn& model) {
    edit::LookCorrection correction(model, *edit::look_named(word));
    DOCTEST_CHECK_FALSE(correction.share());
    auto result = correction.edit({view}, {}, {});
    DOCTEST_REQUIRE(correction.share());
    DOCTEST_CHECK(*correction.share() > 0.9);
    return result.images.front();
}

}  // namespace

DOCTEST_TEST_CASE("every look has its own tones in shade and light, and no other word has any") {
    for (const char* word : {"red", "blue", "white", "black", "golden", "wooden", "stone"}) {
        DOCTEST_CAPTURE(word);
        const auto look = edit::look_named(word);
        DOCTEST_REQUIRE(look);
        const edit::LookTest test(*look);
        for (const float light : {0.1f, 0.5f, 0.9f}) {
            const auto tone = look->tone(light);
            DOCTEST_CHECK(test.has({tone[0], tone[1], tone[2]}, light));
        }
        DOCTEST_CHECK_FALSE(test.has({0.1, 0.6, 0.55}, 0.5f));  // turquoise
    }
    DOCTEST_CHECK_FALSE(edit::look_named("hat"));
    DOCTEST_CHECK_FALSE(edit::look_named(""));
    const edit::LookTest golden(*edit::look_named("golden"));
    DOCTEST_CHECK_FALSE(golden.has({0.45, 0.45, 0.15}, 0.5f));  // olive
}

DOCTEST_TEST_CASE("a model that changes nothing is brought to the look, and shade stays shade") {
    Drawn model;
    const auto view = disc(Bronze, Bronze);
    const auto white = corrected("white", view, model);
    DOCTEST_CHECK(at(white, 16, 4)[2] > 0.9f);
    DOCTEST_CHECK(at(white, 16, 28)[2] > 0.5f);
    DOCTEST_CHECK(at(white, 16, 28)[2] < at(white, 16, 4)[2] - 0.2f);
    DOCTEST_CHECK(at(white, 0, 0) == Rgb{0, 0, 0});  // outside the mask
}

DOCTEST_TEST_CASE("parts of different paint come to the same tones: dark paint is no shade") {
    Drawn model;
    const auto golden = corrected("golden", disc(Green, Blue), model);
    for (const int y : {5, 16, 27})
        for (std::size_t c = 0; c < 3; ++c)
            DOCTEST_CHECK(at(golden, 12, y)[c] == doctest::Approx(at(golden, 20, y)[c]).epsilon(0.1));
}

DOCTEST_TEST_CASE("pictures that have the look already stay as they were drawn") {
    Drawn model;
    const auto view = disc(Green, Green);
    const auto red = edit::look_named("red")->lit;
    model.pictures = {disc(red, red).rendered};
    DOCTEST_CHECK(corrected("red", view, model).data == model.pictures.front().data);
    edit::LookCorrection correction(model, *edit::look_named("red"));
    DOCTEST_CHECK(correction.edit({}, {}, {}).images.size() == 1);  // not as many as views: left alone
    auto unseen = view;
    unseen.mask = Mask(Side, Side);
    DOCTEST_CHECK(correction.edit({unseen}, {}, {}).images.front().data == model.pictures.front().data);
}

}  // namespace look_test
