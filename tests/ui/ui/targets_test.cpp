// The contact sheet of redrawn views: pictures, and orders about them by mouse and by keys. The prompt about
// settings that the method does not use.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::targets_test {
namespace {

constexpr int Wide = 1920, High = 1080;

struct Sheet : Harness {
    explicit Sheet(Situation situation = Situation::Editing) : Harness({Wide, High, 1, situation, false}) {
        shell.show(ui::PanelId::Targets);
        frame(3);
    }
    bool asks(const std::string& widget, const std::string& call) {
        application.calls.clear();
        click(widget);
        frame(2);
        return application.asked(call);
    }
    ui::TargetRound& last() { return application.model().target_rounds.back(); }
};

}  // namespace

DOCTEST_TEST_CASE("a redrawn view is dropped, accepted again and redrawn by its buttons") {
    Sheet sheet;
    for (int view = 0; view < 8; ++view)
        DOCTEST_CHECK(sheet.find("targets." + std::to_string(view)) != nullptr);
    DOCTEST_CHECK(sheet.asks("targets.1.drop", "order_target 1 3 drop"));
    DOCTEST_CHECK(sheet.asks("targets.1.redo", "order_target 1 3 redo"));
    DOCTEST_CHECK(sheet.find("targets.2.drop") == nullptr);  // it is dropped already
    DOCTEST_CHECK(sheet.asks("targets.2.accept", "order_target 1 6 accept"));
    sheet.last().targets[1].ordered = true;  // what was said is still to be done
    sheet.frame(2);
    DOCTEST_CHECK(!sheet.rect("targets.1.drop").enabled);
    DOCTEST_CHECK(sheet.rect("targets.0.drop").enabled);
}

DOCTEST_TEST_CASE("the last view that is used cannot be dropped") {
    Sheet sheet;
    for (std::size_t view = 1; view < 8; ++view) sheet.last().targets[view].dropped = true;
    sheet.frame(2);
    DOCTEST_CHECK(!sheet.rect("targets.0.drop").enabled);
    DOCTEST_CHECK(sheet.rect("targets.0.redo").enabled);
}

DOCTEST_TEST_CASE("a view that was never drawn can be redrawn, and not accepted") {
    Sheet sheet;
    sheet.last().targets[2].missing = true;
    sheet.frame(2);
    DOCTEST_CHECK_FALSE(sheet.rect("targets.2.accept").enabled);
    DOCTEST_CHECK(sheet.asks("targets.2.redo", "order_target 1 6 redo"));
}

DOCTEST_TEST_CASE("nothing is said about a round that is over, or when the edit is") {
    Sheet sheet;
    sheet.click("targets.round.0");
    sheet.frame(2);
    DOCTEST_CHECK(sheet.shell.state().targets.chosen == 0);
    DOCTEST_CHECK(!sheet.rect("targets.1.drop").enabled);
    sheet.click("targets.round.1");
    sheet.frame(2);
    DOCTEST_CHECK(sheet.rect("targets.1.drop").enabled);
    Sheet done(Situation::ResultWaiting);
    DOCTEST_CHECK(!done.rect("targets.1.redo").enabled);
}

DOCTEST_TEST_CASE("an edit that waits for the artist brings the sheet to the front, once") {
    Harness harness({Wide, High, 1, Situation::Editing, false});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Targets") == nullptr);
    harness.application.model().targets_wait = true;
    harness.frame(3);
    DOCTEST_REQUIRE(harness.find("panel.Targets") != nullptr);
    harness.click("targets.fit");
    harness.frame(2);
    DOCTEST_CHECK(harness.application.asked("fit_to_targets"));
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Targets") == nullptr);  // it was seen
    harness.click("progress.targets");
    harness.frame(3);
    DOCTEST_CHECK(harness.find("panel.Targets") != nullptr);
}

DOCTEST_TEST_CASE("the sheet is reached and answered by keys") {
    Sheet sheet;
    sheet.application.model().targets_wait = true;
    constexpr int most = 400;
    const auto tab_to = [&](const std::string& name) {
        for (int presses = 0; presses < most && sheet.shell.focused() != name; ++presses)
            sheet.key(ui::key::Tab);
        return sheet.shell.focused() == name;
    };
    DOCTEST_REQUIRE(tab_to("targets.4.drop"));
    sheet.key(ui::key::Enter);
    DOCTEST_CHECK(sheet.application.asked("order_target 1 12 drop"));
    DOCTEST_REQUIRE(tab_to("targets.4.redo"));
    sheet.key(ui::key::Space);
    DOCTEST_CHECK(sheet.application.asked("order_target 1 12 redo"));
    DOCTEST_REQUIRE(tab_to("targets.fit"));
    sheet.key(ui::key::Enter);
    DOCTEST_CHECK(sheet.application.asked("fit_to_targets"));
    DOCTEST_REQUIRE(tab_to("targets.review"));
    sheet.key(ui::key::Space);
    DOCTEST_CHECK(sheet.application.model().model_settings.review);
}

DOCTEST_TEST_CASE("iterations are those of the method that leads the edit") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    request.method = "views";
    request.mode = "modify";
    request.rounds = 2;
    request.fit_steps = 40;
    const int pulled = request.iterations;
    harness.frame(2);
    const auto place = harness.middle("prompt.iterations");
    harness.drag(place, {place.x + 120, place.y});
    const auto& now = harness.application.model().request;
    DOCTEST_CHECK(now.fit_steps > 40);
    DOCTEST_CHECK(now.iterations == pulled);
    harness.application.model().request.method = "sds";
    harness.frame(60);                                       // else two presses are a double click
    const auto moved = harness.middle("prompt.iterations");  // the quality counts for views alone
    harness.drag(moved, {moved.x + 120, moved.y});
    DOCTEST_CHECK(harness.application.model().request.iterations > pulled);
}

DOCTEST_TEST_CASE(
    "what a sentence that nobody has clicked a word of will do says whose iterations are shown") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    request.source = "bear";
    request.prompt = "a cat on the grass";  // another thing in its place
    request.target.clear();
    const int fit_steps = request.fit_steps, shape_fit_steps = request.shape_fit_steps;
    harness.frame(3);
    const auto place = harness.middle("prompt.iterations");
    harness.drag(place, {place.x + 120, place.y});
    const auto& now = harness.application.model().request;
    DOCTEST_CHECK(now.shape_fit_steps > shape_fit_steps);
    DOCTEST_CHECK(now.fit_steps == fit_steps);
}

DOCTEST_TEST_CASE("what the job has asked of the networks stands beside its time") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    harness.click("progress.cost");
    harness.frame(2);
    DOCTEST_CHECK(harness.find("progress.networks") != nullptr);
}

}  // namespace gse::test::targets_test
