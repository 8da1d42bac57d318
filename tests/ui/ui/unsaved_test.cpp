// Actions that would lose work ask first and say what becomes of it; offers to have work back.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/file.h"
#include "tests/test_paths.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::unsaved_test {
namespace {

constexpr int Wide = 1600, High = 900;

void ask_to_quit(Harness& harness) {
    harness.application.calls.clear();
    harness.shell.request_quit();
    harness.frame(3);
}

std::size_t count_calls(const Harness& harness, const std::string& call) {
    return static_cast<std::size_t>(
        std::count(harness.application.calls.begin(), harness.application.calls.end(), call));
}

}  // namespace

DOCTEST_TEST_CASE("quitting in the middle of an edit asks: keep, wait or discard") {
    Harness harness({Wide, High, 1, Situation::Editing, false});
    auto& model = harness.application.model();
    model.file_job.running = false;
    ask_to_quit(harness);
    DOCTEST_REQUIRE(harness.find("question.2") != nullptr);
    DOCTEST_CHECK(harness.shell.state().question.text.find("212 of 400") != std::string::npos);
    harness.click("question.1");  // wait
    DOCTEST_CHECK(!harness.application.asked("leave_edit"));
    DOCTEST_CHECK(!harness.application.asked("quit"));
    ask_to_quit(harness);
    harness.key(ui::key::Escape);
    DOCTEST_CHECK(!harness.application.asked("leave_edit"));
    ask_to_quit(harness);
    harness.click(
        "question.0");  // stop and keep: all else that is unsaved is kept too, nothing more is asked
    harness.frame(3);
    DOCTEST_REQUIRE(harness.application.calls.size() >= 2);
    DOCTEST_CHECK(harness.application.calls[0] == "leave_edit keep");
    DOCTEST_CHECK(harness.application.calls[1] == "quit");
}

DOCTEST_TEST_CASE("an answer can be seen only where it stays: a click at its place hits it") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    harness.shell.request_quit();
    const auto places = [&](const std::string& name) {
        std::vector<ui::Rect> seen;
        for (int frame = 0; frame < 6; ++frame) {
            harness.frame();
            if (const auto* answer = harness.find(name); answer != nullptr && answer->visible)
                seen.push_back(*answer);
        }
        return seen;
    };
    const auto check = [](const std::vector<ui::Rect>& seen) {
        DOCTEST_REQUIRE(seen.size() >= 2);
        for (const auto& place : seen) {
            DOCTEST_CHECK(place.x == seen.back().x);
            DOCTEST_CHECK(place.y == seen.back().y);
        }
    };
    check(places("question.2"));
    // The next question takes the place of a larger one.
    const auto* discard = harness.find("question.2");
    DOCTEST_REQUIRE(discard != nullptr);
    harness.move(discard->x + discard->width / 2, discard->y + discard->height / 2);
    harness.press();
    harness.release();
    check(places("question.1"));
}

DOCTEST_TEST_CASE("a discarded edit does not take other unsaved work along") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    ask_to_quit(harness);
    harness.click("question.2");  // discard it
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("leave_edit discard"));
    DOCTEST_CHECK(!harness.application.asked("quit"));
    DOCTEST_REQUIRE(harness.find("question.1") != nullptr);  // the changes since the last save
    harness.click("question.1");
    harness.frame(3);
    DOCTEST_CHECK(count_calls(harness, "quit") == 1);
    // The same with nothing else unsaved.
    Harness saved({Wide, High, 1, Situation::ResultWaiting, false});
    ask_to_quit(saved);
    DOCTEST_REQUIRE(saved.find("question.2") != nullptr);
    saved.application.model().unsaved = false;
    saved.click("question.2");
    saved.frame(3);
    DOCTEST_CHECK(count_calls(saved, "quit") == 1);
}

DOCTEST_TEST_CASE("opening another scene in the middle of an edit asks, a picture's recipe does not") {
    Harness harness({Wide, High, 1, Situation::Editing, false});
    harness.application.calls.clear();
    harness.shell.request_open({"/tmp/recipe.png"});
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("open /tmp/recipe.png"));
    harness.shell.request_open({"/tmp/other.ply"});
    harness.frame(3);
    DOCTEST_CHECK(!harness.application.asked("open /tmp/other.ply"));
    harness.click("question.0");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("leave_edit keep"));
    DOCTEST_CHECK(harness.application.asked("open /tmp/other.ply"));
}

DOCTEST_TEST_CASE("cameras are no other scene: they are opened without a question") {
    const ScratchFolder scratch;
    const auto cameras = scratch.path() / "cameras.json";
    write_file(cameras, "[]");
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().unsaved = true;
    for (const auto& path : {cameras, scratch.path()}) {
        harness.application.calls.clear();
        harness.shell.request_open({path});
        harness.frame(3);
        DOCTEST_CHECK(harness.application.asked("open " + path.string()));
    }
}

DOCTEST_TEST_CASE("a film that is still written is waited for or stopped, on purpose") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.unsaved = false;
    model.file_job.running = true;
    model.file_job.title = "Turntable turn.mp4";
    ask_to_quit(harness);
    DOCTEST_REQUIRE(harness.find("question.1") != nullptr);
    harness.click("question.0");
    DOCTEST_CHECK(!harness.application.asked("quit"));
    ask_to_quit(harness);
    harness.click("question.1");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("cancel_file_job"));
    DOCTEST_CHECK(harness.application.asked("quit"));
}

DOCTEST_TEST_CASE("Save as and then go on: the window closes once it is saved") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().project_path.clear();
    harness.application.model().suggested_project = "/tmp/scene.gsep";
    ask_to_quit(harness);
    harness.click("question.0");
    harness.frame(3);
    DOCTEST_CHECK(!harness.application.asked("quit"));
    harness.click("files.confirm");
    harness.frame(3);
    DOCTEST_REQUIRE(harness.application.calls.size() >= 2);
    DOCTEST_CHECK(harness.application.calls[0] == "save_project /tmp/scene.gsep");
    DOCTEST_CHECK(harness.application.calls[1] == "quit");
}

DOCTEST_TEST_CASE("what another session left is offered over an open scene") {
    Harness harness({Wide, High, 1, Situation::Scene, true});
    auto& model = harness.application.model();
    model.unsaved = false;
    model.recoverable = {recovery_of("kitchen"), recovery_of("garden")};
    model.recoverable[0].offered = false;
    harness.frame(3);
    DOCTEST_CHECK(harness.find("recovery.recover.0") == nullptr);  // of another scene
    DOCTEST_CHECK(harness.find("recovery.thumbnail.1") != nullptr);
    harness.application.calls.clear();
    harness.click("recovery.later.1");
    DOCTEST_CHECK(harness.application.asked("postpone_recovery " + model.recoverable[1].file));
    harness.click("recovery.recover.1");
    DOCTEST_CHECK(harness.application.asked("recover " + model.recoverable[1].file));
    harness.click("recovery.discard.1");
    DOCTEST_CHECK(!harness.application.asked("discard_recovery"));
    DOCTEST_CHECK(harness.shell.state().question.text.find("garden.ply, today 14:02") != std::string::npos);
    harness.click("question.0");
    DOCTEST_CHECK(harness.application.asked("discard_recovery " + model.recoverable[1].file));
    harness.application.calls.clear();
    model.unsaved = true;  // work here would be replaced
    harness.click("recovery.recover.1");
    DOCTEST_CHECK(!harness.application.asked("recover "));
    DOCTEST_CHECK(harness.find("question.2") != nullptr);
}

DOCTEST_TEST_CASE("a question of the application is shown once and answered once") {
    Harness harness({Wide, High, 1, Situation::Nothing, false});
    auto& model = harness.application.model();
    model.question = {1,
                      "Which one?",
                      "There are several.",
                      {{"a.ply", "1.0 MB", false, true}, {"b.ply", "2.0 MB", false, true}, {"Cancel"}}};
    harness.frame(3);
    harness.application.calls.clear();
    harness.click("question.1");
    DOCTEST_CHECK(count_calls(harness, "answer 1") == 1);
    harness.frame(5);
    DOCTEST_CHECK(harness.find("question.1") == nullptr);
    model.question.number = 2;
    harness.frame(3);
    harness.click("question.2");
    DOCTEST_CHECK(count_calls(harness, "answer 2") == 1);
}

}  // namespace gse::test::unsaved_test
