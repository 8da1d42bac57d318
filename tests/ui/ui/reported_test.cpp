// Small things that were reported, by clicks and keys: names without an ending, turntables, one clock for one
// job, and the words for a stopped edit.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/test_paths.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"
#include "ui/state/status.h"
#include "ui/widgets/controls.h"

namespace gse::test::reported_test {
namespace {

constexpr int Wide = 1600, High = 1000;

/// The wheel over the panel Export until the control is in sight.
void scroll_to(Harness& harness, const std::string& name) {
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    for (int notch = 0; notch < 60 && !harness.rect(name).visible; ++notch) {
        const auto panel = harness.rect("panel.Export");
        harness.move(panel.x + panel.width / 2, panel.y + panel.height / 2);
        harness.wheel(-2);
    }
}

void write_name(Harness& harness, const std::string& name) {
    harness.click("files.name");
    harness.modifiers(false, true, false);
    harness.key('A');
    harness.modifiers(false, false, false);
    harness.type(name);
    harness.frame(2);
}

}  // namespace

DOCTEST_TEST_CASE("a project's name without its ending is completed; another ending is kept before it") {
    const ScratchFolder scratch;
    for (const auto& [typed, written] : {std::pair{"bear", "bear.gsep"},
                                         {"bear.v2", "bear.v2.gsep"},
                                         {"bear.gsep", "bear.gsep"},
                                         {"bear.GSEP", "bear.GSEP"}}) {
        Harness harness({Wide, High, 1, Situation::Scene, false});
        harness.application.model().project_path = (scratch.path() / "old.gsep").string();
        harness.modifiers(true, true, false);
        harness.key('S');
        harness.modifiers(false, false, false);
        harness.frame(3);
        write_name(harness, typed);
        DOCTEST_REQUIRE(harness.rect("files.confirm").enabled);
        harness.click("files.confirm");
        harness.frame(3);
        DOCTEST_CHECK(harness.application.asked("save_project " + (scratch.path() / written).string()));
    }
}

DOCTEST_TEST_CASE("a file to export is completed, too") {
    const ScratchFolder scratch;
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& exports = harness.application.model().exports;
    exports.picture_path = (scratch.path() / "old.png").string();
    scroll_to(harness, "export.picture_path.browse");
    harness.click("export.picture_path.browse");
    harness.frame(3);
    write_name(harness, "new");
    harness.click("files.confirm");
    harness.frame(3);
    DOCTEST_CHECK(exports.picture_path == (scratch.path() / "new.png").string());
}

DOCTEST_TEST_CASE(
    "a turntable shows the scene from where the artist looks, unless that is chosen otherwise") {
    DOCTEST_CHECK_FALSE(ui::ExportSettings{}.around_label);
    DOCTEST_CHECK(ui::ExportSettings{}.start_degrees == 0);  // from there
    Harness harness({Wide, High, 1, Situation::Located, false});
    auto& exports = harness.application.model().exports;
    scroll_to(harness, "export.around_label");
    DOCTEST_CHECK_FALSE(exports.around_label);  // also where something is labelled
    harness.click("export.around_label");
    DOCTEST_CHECK(exports.around_label);
    scroll_to(harness, "export.turntable");
    DOCTEST_CHECK(harness.asks("export.turntable", "export_turntable"));
}

DOCTEST_TEST_CASE("one job has one time, wherever it is told") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    auto& model = harness.application.model();
    for (const double seconds : {0.04, 1.23, 9.96, 59.7, 93.6, 4000.0}) {
        model.job.seconds = model.result_seconds = seconds;
        const auto time = ui::duration_text(seconds);
        DOCTEST_CHECK(ui::job_line(model).find("done in " + time) != std::string::npos);
        DOCTEST_CHECK(ui::result_line(model) == "Edit done in " + time);
        DOCTEST_CHECK(ui::outcome_text(model.job) == "done in " + time);
    }
    harness.frame(2);
    DOCTEST_CHECK(harness.find("result.time") != nullptr);
    DOCTEST_CHECK(harness.find("job.outcome") != nullptr);
}

DOCTEST_TEST_CASE("several changes have one time together while they wait") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    auto& model = harness.application.model();
    model.job.title = "Edit: a blue bear wearing a red hat (step 2 of 2)";
    model.job.seconds = 4;
    model.result_seconds = 7;
    model.verdict.changes = {"a blue bear", "a blue bear wearing a red hat"};
    DOCTEST_CHECK(ui::job_line(model) == "Edit done in 7.0 s. Apply or discard it");
}

DOCTEST_TEST_CASE("a stopped edit is not called done, in any place") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    auto& model = harness.application.model();
    model.verdict.stopped_at = 12;
    model.verdict.steps = 40;
    model.job.outcome = "stopped";
    const auto never_done = [&] {
        for (const auto& text :
             {ui::job_line(model), ui::result_line(model), ui::result_sentence(model.verdict)}) {
            DOCTEST_CHECK(text.find("done") == std::string::npos);
            DOCTEST_CHECK(text.find("topped") != std::string::npos);
        }
    };
    never_done();
    model.job.title.clear();  // another program has kept the work: nothing ran in this one
    never_done();
    DOCTEST_CHECK(ui::result_line(model).find("12 of 40") != std::string::npos);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("result.apply", "apply_result"));  // it can be kept all the same
}

}  // namespace gse::test::reported_test
