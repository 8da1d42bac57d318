// The window's own state that belongs to one scene is forgotten when another one is open.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/state/state.h"

namespace gse::test::stale_test {

DOCTEST_TEST_CASE(
    "places, tools, pictures and questions of a scene are forgotten with it, settings are not") {
    Harness harness({1600, 900, 1, Situation::Located, false});
    harness.application.model().opened = 1;
    harness.frame(2);
    auto& state = harness.shell.state();
    const ui::UiState fresh;
    state.viewport.tool = ui::Tool::Lasso;
    state.viewport.operation = ui::SetOperation::Remove;
    state.viewport.selected_view = 3;
    state.attention.chosen = 5;
    state.attention.over = ui::Over::Mask;
    state.attention.points = false;
    state.attention.problem_shown = 1;
    state.labels.renamed = 1;
    state.labels.threshold = 0.4f;
    state.pick.within = true;
    state.pick.choices[0].threshold = 0.7f;
    state.by_hand.adjust.values.brightness = 2;
    state.targets.chosen = 1;
    state.history.chosen = 7;
    state.progress.logarithmic = false;
    state.question = {
        "Delete the bear?", "It is gone then.", {{"Delete", true, {}}, {"Keep", false, {}}}, true};
    harness.frame(2);
    DOCTEST_REQUIRE(harness.find("question.0") != nullptr);
    harness.application.model().opened = 2;
    harness.frame(3);
    DOCTEST_CHECK(harness.find("question.0") == nullptr);
    DOCTEST_CHECK(state.question.title.empty());
    DOCTEST_CHECK(state.viewport.tool == fresh.viewport.tool);
    DOCTEST_CHECK(state.viewport.operation == fresh.viewport.operation);
    DOCTEST_CHECK(state.viewport.selected_view == fresh.viewport.selected_view);
    DOCTEST_CHECK(state.attention.chosen == fresh.attention.chosen);
    DOCTEST_CHECK(state.attention.over == fresh.attention.over);
    DOCTEST_CHECK(state.labels.renamed == fresh.labels.renamed);
    DOCTEST_CHECK(state.labels.threshold == fresh.labels.threshold);
    DOCTEST_CHECK(state.pick.within == fresh.pick.within);
    DOCTEST_CHECK(state.by_hand.adjust.values == fresh.by_hand.adjust.values);
    DOCTEST_CHECK(state.targets.chosen == fresh.targets.chosen);
    DOCTEST_CHECK(state.history.chosen == fresh.history.chosen);
    DOCTEST_CHECK_FALSE(state.attention.points);
    DOCTEST_CHECK_FALSE(state.progress.logarithmic);
    DOCTEST_CHECK(state.pick.choices[0].threshold == 0.7f);
}

DOCTEST_TEST_CASE("a field that is being typed into does not put the last scene's words into the next one") {
    Harness harness({1600, 900, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.opened = 1;
    harness.frame(2);
    harness.click("prompt.sentence");
    harness.type("s");
    DOCTEST_REQUIRE(model.request.prompt != "");
    model.opened = 2;
    model.request.prompt.clear();
    harness.frame(3);
    harness.click("prompt.source");  // the other field loses the keyboard
    DOCTEST_CHECK(model.request.prompt == "");
}

}  // namespace gse::test::stale_test
