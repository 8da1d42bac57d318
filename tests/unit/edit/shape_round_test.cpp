// The outline of a new thing in a redrawn picture.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/edit/target_views/shape_round.h"
#include "tests/unit/edit/edit_scenes.h"

namespace shape_round_test {

namespace {

using namespace gse;

constexpr int Side = 64;
constexpr double Core = 10,
                 Reach = 30;  // attention is 1 within the first radius and falls evenly to 0 at the second

double radius_at(int x, int y) { return std::hypot(x + 0.5 - Side / 2, y + 0.5 - Side / 2); }

class SlopingAttention : public edit::AttentionSource {
public:
    explicit SlopingAttention(double threshold) : threshold_(threshold) {}
    std::vector<Image> locate(const edit::AttentionQuery&) override {
        Image map(Side, Side, 1);
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                map.at(x, y, 0) =
                    static_cast<float>(std::clamp((Reach - radius_at(x, y)) / (Reach - Core), 0.0, 1.0));
        return {map};
    }
    double threshold() const override { return threshold_; }
    int image_size() const override { return Side; }

private:
    double threshold_;
};

edit::EditView grey_view(float clean_plate) {
    edit::EditView view;
    view.mask = Mask(Side, Side);
    std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{1});
    view.clean_plate.picture = Image(Side, Side, 3, clean_plate);
    return view;
}

/// A picture that differs from a black clean plate within a radius.
Image disc_picture(double radius, float colour) {
    Image picture(Side, Side, 3);
    for (int y = 0; y < Side; ++y)
        for (int x = 0; x < Side; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = radius_at(x, y) < radius ? colour : 0.0f;
    return picture;
}

/// Radius of the disc that has as many pixels as the outline covers.
double outline_radius(double threshold, Image picture, float clean_plate = 0) {
    const edit::EditPlan plan;
    const auto request = test::asked("bear", "a cat on the grass", "cat");
    SlopingAttention attention(threshold);
    const edit::ShapeFinder finder(plan, request, "cat", attention);
    Image outline;
    const Image before = picture;
    edit::EditedViews drawn{{std::move(picture)}, {}, {}};
    DOCTEST_REQUIRE(finder.take_out(grey_view(clean_plate), drawn, 0, 1, &outline));
    const Image& after = drawn.images.front();
    double covered = 0;
    for (const float share : outline.data) covered += share;
    DOCTEST_CHECK(after.at(Side / 2, Side / 2, 0) == before.at(Side / 2, Side / 2, 0));  // the thing stays,
    DOCTEST_CHECK(after.at(1, 1, 0) == clean_plate);  // what is beyond it becomes the clean plate
    return std::sqrt(covered / 3.141592653589793);
}

double radius_of(double attention) { return Reach - attention * (Reach - Core); }

constexpr double Possible = 0.85;  // share of the threshold that does for what differs
constexpr double Pixel = 1;        // the softened rim is one wide

}  // namespace

DOCTEST_TEST_CASE(
    "the new thing reaches as far as it differs from the clean_plate, where the word is seen but not "
    "clearly") {
    for (const auto& [threshold, radius] :
         {std::pair{0.5, 19.0}, std::pair{0.5, 20.5}, std::pair{0.7, 15.0}, std::pair{0.7, 17.0}}) {
        DOCTEST_REQUIRE(radius > radius_of(1.2 * threshold) + Pixel / 2);
        DOCTEST_REQUIRE(radius < radius_of(Possible * threshold) - Pixel / 2);
        const double found = outline_radius(threshold, disc_picture(radius, 0.5f));
        DOCTEST_CHECK(std::abs(found - radius) < Pixel / 2);
    }
}

DOCTEST_TEST_CASE(
    "where the model tells what is new in its picture, that is the new thing, whatever the word draws") {
    const edit::EditPlan plan;
    const auto request = test::asked("bear", "a cat on the grass", "cat");
    SlopingAttention attention(0.5);
    const edit::ShapeFinder finder(plan, request, "cat", attention);
    Image told(Side, Side, 1), outline;
    for (int y = 20; y < 50; ++y)
        for (int x = 40; x < 60; ++x) told.at(x, y, 0) = x < 42 ? 0.25f : 1.0f;
    edit::EditedViews drawn{{Image(Side, Side, 3, 0.75f)}, {}, {told}};
    DOCTEST_REQUIRE(finder.take_out(grey_view(0.25f), drawn, 0, 1, &outline));
    DOCTEST_CHECK(outline.data == told.data);
    DOCTEST_CHECK(drawn.images.front().at(50, 30, 0) == 0.75f);
    DOCTEST_CHECK(drawn.images.front().at(41, 30, 0) == 0.375f);  // a quarter of it
    DOCTEST_CHECK(drawn.images.front().at(32, 32, 0) == 0.25f);
    edit::EditedViews empty{{Image(Side, Side, 3, 0.75f)}, {}, {Image(Side, Side, 1, 0.3f)}};
    DOCTEST_CHECK(!finder.take_out(grey_view(0.25f), empty, 0, 1));
}

DOCTEST_TEST_CASE(
    "what is added reaches a little further into the soft rim of its outlines than what becomes another") {
    edit::CutOut found;
    for (const auto& view : test::ball_views(8, Side)) {
        edit::HullView outline{view.camera, Image(Side, Side, 1), {}, Image(Side, Side, 3, 0.5f)};
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                outline.inside.at(x, y, 0) =
                    static_cast<float>(std::clamp(1.5 - radius_at(x, y) / 16, 0.0, 1.0));
        found.outlines.push_back(std::move(outline));
        found.usable.push_back(found.usable.size());
    }
    const auto request = test::asked("bear", "a cat on the grass", "cat");
    SlopingAttention attention(0.5);
    const auto reach = [&](edit::EditMode mode) {
        edit::EditPlan plan;
        plan.mode = mode;
        const auto rows = edit::ShapeFinder(plan, request, "hat", attention)
                              .seeds(found, {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}, 0);
        float most = 0;
        for (const float value : rows.position) most = std::max(most, std::abs(value));
        return most;
    };
    const float another = reach(edit::EditMode::Replace), added = reach(edit::EditMode::Add);
    DOCTEST_CHECK(another > 0);
    DOCTEST_CHECK(added > 1.03f * another);  // radii of 1.0 and 1.1 times 16 pixels
    DOCTEST_CHECK(added < 1.2f * another);
}

DOCTEST_TEST_CASE("what differs where the word is not seen is not of the new thing") {
    for (const double threshold : {0.3, 0.5, 0.7}) {
        const double radius = outline_radius(threshold, Image(Side, Side, 3, 0.5f));
        DOCTEST_CHECK(radius == doctest::Approx(radius_of(Possible * threshold)).epsilon(2 * Pixel / radius));
    }
}

DOCTEST_TEST_CASE("a thing of the clean_plate's colour is where the word is seen clearly") {
    for (const double threshold : {0.3, 0.5, 0.7}) {
        const double radius = outline_radius(threshold, Image(Side, Side, 3, 0.5f), 0.5f);
        DOCTEST_CHECK(radius == doctest::Approx(radius_of(std::min(1.2 * threshold, (1 + threshold) / 2)))
                                    .epsilon(2 * Pixel / radius));
    }
    for (const double threshold : {0.85, 0.95, 0.99})  // however high: something of it is left
        DOCTEST_CHECK(outline_radius(threshold, Image(Side, Side, 3, 0.5f), 0.5f) > Core - 2);
}

}  // namespace shape_round_test
