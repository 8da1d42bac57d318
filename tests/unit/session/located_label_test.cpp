// Labels of a document at other thresholds: decided anew from what their views said.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "app/session/state/located_label.h"
#include "engine/edit/search/decide_label.h"
#include "engine/scene/label_ops.h"
#include "tests/unit/edit/edit_scenes.h"

namespace located_label_test {

using namespace gse;

namespace {

/// The red ball as views say it that are not sure of every row.
struct Found {
    test::BallScene scene = test::ball_scene(150);
    NamedLabel label;

    Found() {
        Random random(4);
        FoundField found;
        for (const auto first : scene.first) {
            const double sure = first != 0 ? 0.65 : 0.3;
            found.field.probability.push_back(static_cast<float>(sure + random.uniform(-0.3, 0.3)));
            found.field.coverage.push_back(5);
        }
        found.rule.smoothness = 1.5;
        label.name = "ball";
        label.found = std::make_shared<const FoundField>(std::move(found));
        label = app::at_threshold(std::move(label), scene.set, 0.5);
    }
};

}  // namespace

DOCTEST_TEST_CASE("a slid label is decided anew, back and forth, and corrections by hand stay") {
    const Found found;
    const auto& set = found.scene.set;
    const NamedLabel corrected = combine(
        found.label,
        [&] {
            std::vector<std::uint8_t> rows(set.size(), 0);
            rows[0] = 1;
            return rows;
        }(),
        LabelOperation::Remove);
    int differs = 0;
    for (const double threshold : std::array{0.3, 0.4, 0.6, 0.7}) {
        DOCTEST_CAPTURE(threshold);
        const auto slid = app::at_threshold(corrected, set, threshold);
        auto expected = *edit::decide_label("ball", set, *found.label.found, threshold).label.bits;
        expected[0] = 0;
        DOCTEST_CHECK(*slid.bits == expected);
        DOCTEST_CHECK(slid.threshold == static_cast<float>(threshold));
        differs += *with_threshold(corrected, slid.threshold).bits != expected ? 1 : 0;
        const auto back = app::at_threshold(slid, set, 0.5);
        DOCTEST_CHECK(*back.bits == *corrected.bits);
        DOCTEST_CHECK(*back.weight == *corrected.weight);
    }
    DOCTEST_CHECK(differs > 0);  // the weights of one threshold are wrong at another
}

DOCTEST_TEST_CASE("a label without a field, or of other rows, compares its weights") {
    const Found found;
    NamedLabel plain = found.label;
    plain.found = nullptr;
    const auto slid = app::at_threshold(plain, found.scene.set, 0.7);
    DOCTEST_CHECK(*slid.bits == *with_threshold(plain, 0.7f).bits);
    DOCTEST_CHECK(*slid.weight == *plain.weight);
    const auto fewer = found.scene.set.filtered(found.scene.first);
    DOCTEST_CHECK(*app::at_threshold(found.label, fewer, 0.7).bits == *slid.bits);
    DOCTEST_CHECK(view_probability(found.label)->size() == found.scene.set.size());
    DOCTEST_CHECK(*view_probability(found.label) == found.label.found->field.probability);
    DOCTEST_CHECK(view_probability(plain) == plain.weight);
}

}  // namespace located_label_test
