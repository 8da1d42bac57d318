// A label slides over what the views said: at every threshold it is what a fresh vote there gives.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/search/decide_label.h"
#include "tests/unit/edit/locate_scenes.h"

namespace label_threshold_test {

using namespace locate_scenes;

DOCTEST_TEST_CASE("a label at another threshold is that of a fresh vote at it") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.least_confidence = 0;
    edit::LocateCache cache;
    const auto search = [&](double threshold) {
        request.label_threshold = threshold;
        auto tools = fixture.tools();
        tools.cache = &cache;
        return edit::locate(fixture.input(request), tools);
    };
    constexpr double First = 0.4;
    const auto found = search(First);
    const auto before = found.found.field.probability;
    int fresh_labels = 0, wrong_by_weight = 0;
    for (const double threshold : {0.1, 0.2, 0.3, First, 0.5, 0.6, 0.7, 0.8}) {
        DOCTEST_CAPTURE(threshold);
        const auto fresh = search(threshold);
        if (fresh.problem == edit::SearchProblem::NothingLabelled) continue;
        const auto slid = edit::decide_label(found.word, fixture.scene.set, found.found, threshold).label;
        DOCTEST_CHECK(*slid.bits == *fresh.label.bits);
        DOCTEST_CHECK(test::same_bytes(*slid.weight, *fresh.label.weight));
        const auto by_weight = make_label("ball", *found.label.weight, static_cast<float>(threshold));
        wrong_by_weight += *by_weight.bits != *fresh.label.bits ? 1 : 0;
        ++fresh_labels;
    }
    DOCTEST_CHECK(fresh_labels >= 6);
    // Weights that a search has rewritten are right at its threshold only.
    DOCTEST_CHECK(wrong_by_weight >= 2);
    DOCTEST_CHECK(found.found.field.probability == before);
}

DOCTEST_TEST_CASE("weights of a label lie on the side of the threshold where its bits are") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.least_confidence = 0;
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    std::size_t moved = 0;
    for (const double threshold : {0.25, 0.4, 0.6}) {
        const auto label = edit::decide_label("ball", fixture.scene.set, found.found, threshold).label;
        for (std::size_t row = 0; row < label.bits->size(); ++row) {
            const bool known = found.found.field.coverage[row] > found.found.rule.least_coverage;
            if (known) DOCTEST_CHECK(((*label.weight)[row] > threshold) == ((*label.bits)[row] != 0));
            moved += known && (*label.weight)[row] != found.found.field.probability[row] ? 1 : 0;
        }
    }
    DOCTEST_CHECK(moved > 0);
}

}  // namespace label_threshold_test
