// GrabCut and the threshold on a picture with one clear object.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/localize/clusters.h"

namespace segmenter_test {

namespace {

using namespace gse;

struct Picture {
    Image image{80, 60, 3};
    Mask truth{80, 60};
    Image hint;
};

/// A noisy red disc on noisy green; the hint is a smaller blob, off centre.
Picture disc() {
    Picture picture;
    Random random(2);
    Image blob(80, 60, 1);
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 80; ++x) {
            const bool inside = std::hypot(x - 42, y - 30) < 17;
            picture.truth.at(x, y) = inside ? 1 : 0;
            const float noise = static_cast<float>(random.uniform(-0.08, 0.08));
            picture.image.at(x, y, 0) = (inside ? 0.8f : 0.2f) + noise;
            picture.image.at(x, y, 1) = (inside ? 0.2f : 0.6f) + noise;
            picture.image.at(x, y, 2) = 0.2f + noise;
            blob.at(x, y, 0) =
                static_cast<float>(std::exp(-(std::pow(x - 38, 2) + std::pow(y - 33, 2)) / 200));
        }
    picture.hint = blob;
    return picture;
}

const std::vector<edit::PointPrompt> Clicks{
    {38.5, 33.5, true}, {45.5, 27.5, true}, {5.5, 5.5, false}, {75.5, 50.5, false}};

double iou(const Mask& a, const Mask& b) {
    double both = 0, either = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        both += a.data[i] != 0 && b.data[i] != 0 ? 1 : 0;
        either += a.data[i] != 0 || b.data[i] != 0 ? 1 : 0;
    }
    return both / either;
}

}  // namespace

DOCTEST_TEST_CASE("GrabCut finds the outline that the hint only guesses, the same every time") {
    if (!edit::grabcut_available()) return;
    const Picture picture = disc();
    const auto segmenter = edit::make_grabcut_segmenter();
    const edit::BoxPrompt box{26, 20, 52, 46};
    const Mask mask = segmenter->segment(picture.image, Clicks, box, picture.hint);
    constexpr double LeastIou = 0.95;  // a clean disc on a clean ground
    DOCTEST_CHECK(iou(mask, picture.truth) > LeastIou);
    DOCTEST_CHECK(iou(localize::threshold_map(picture.hint, 0.5), picture.truth) <
                  0.6);  // there was something to do
    // Remembered.
    DOCTEST_CHECK(segmenter->segment(picture.image, Clicks, box, picture.hint).data == mask.data);
    DOCTEST_CHECK(edit::make_grabcut_segmenter()->segment(picture.image, Clicks, box, picture.hint).data ==
                  mask.data);
    DOCTEST_CHECK(iou(segmenter->segment(picture.image, Clicks, std::nullopt, picture.hint), picture.truth) >
                  LeastIou);
    DOCTEST_CHECK(iou(segmenter->segment(picture.image, Clicks, edit::BoxPrompt{22, 10, 62, 50}, {}),
                      picture.truth) > LeastIou);
}

DOCTEST_TEST_CASE("without samples of both kinds the marks come back as they are") {
    const Picture picture = disc();
    const auto segmenter = edit::make_default_segmenter();
    DOCTEST_CHECK(segmenter->segment(picture.image, {}, std::nullopt, {}).count() == 0);
    DOCTEST_CHECK(segmenter->segment(picture.image, {}, std::nullopt, Image(80, 60, 1, 1.0f)).count() ==
                  80 * 60);
    DOCTEST_CHECK(segmenter->segment(Image(80, 60, 3), Clicks, std::nullopt, Image(80, 60, 1)).count() >
                  0);  // one flat colour
}

DOCTEST_TEST_CASE("the threshold segmenter follows hint, clicks and box") {
    const Picture picture = disc();
    const auto segmenter = edit::make_threshold_segmenter(0.4);
    const Mask mask = segmenter->segment(picture.image, Clicks, std::nullopt, picture.hint);
    DOCTEST_CHECK(mask.at(38, 33) == 1);
    DOCTEST_CHECK(mask.at(5, 5) == 0);
    DOCTEST_CHECK(mask.at(70, 10) == 0);
    DOCTEST_CHECK(segmenter->segment(picture.image, {}, edit::BoxPrompt{10, 10, 20, 30}, {}).count() == 200);
    DOCTEST_CHECK_FALSE(segmenter->name().empty());
}

}  // namespace segmenter_test
