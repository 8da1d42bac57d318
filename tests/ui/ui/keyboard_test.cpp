// The window without a mouse: Tab, arrows, Enter, F6 and Alt reach and press everything.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::keyboard_test {
namespace {

namespace key = ui::key;
constexpr int Wide = 1920, High = 1080;
constexpr int MostControls = 400;

bool key_asks(Harness& harness, int index, const std::string& call) {
    harness.application.calls.clear();
    harness.key(index);
    return harness.application.asked(call);
}

/// Presses Tab until the control has the focus; false when it never does.
bool tab_to(Harness& harness, const std::string& name) {
    for (int presses = 0; presses < MostControls; ++presses) {
        if (harness.shell.focused() == name) return true;
        harness.key(key::Tab);
    }
    return false;
}

void tap_alt(Harness& harness) {
    harness.modifiers(false, false, true);
    harness.frame(2);
    harness.modifiers(false, false, false);
    harness.frame(3);
}

/// Names that a mouse can press now.
std::set<std::string> pressable(const Harness& harness) {
    std::set<std::string> names;
    for (const auto& [name, rect] : harness.shell.widgets())
        if (rect.enabled && rect.visible) names.insert(name);
    return names;
}

}  // namespace

DOCTEST_TEST_CASE("Tab begins at the prompt and types, Shift + Tab goes back") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    DOCTEST_CHECK(harness.shell.focused().empty());
    harness.key(key::Tab);
    DOCTEST_CHECK(harness.shell.focused() == "prompt.source");
    harness.type("dog");
    DOCTEST_CHECK(harness.application.model().request.source == "dog");
    harness.key(key::Tab);
    DOCTEST_CHECK(harness.shell.focused() == "prompt.sentence");
    harness.type("a blue dog");
    DOCTEST_CHECK(harness.application.model().request.prompt == "a blue dog");
    harness.modifiers(true, false, false);
    harness.key(key::Tab);
    DOCTEST_CHECK(harness.shell.focused() == "prompt.source");
    harness.type("cat");
    harness.modifiers(false, false, false);
    DOCTEST_CHECK(harness.application.model().request.source == "cat");
    DOCTEST_CHECK(harness.application.model().view.tint_labels);  // Tab is not the tint's key any more
}

DOCTEST_TEST_CASE("Tab goes once around all buttons, fields and sliders of every situation") {
    for (const auto situation : {Situation::Nothing, Situation::Scene, Situation::Located, Situation::Editing,
                                 Situation::ResultWaiting}) {
        Harness harness({Wide, High, 1, situation, false});
        std::set<std::string> reached;
        for (int presses = 0; presses < MostControls; ++presses) {
            harness.key(key::Tab);
            const std::string now = harness.shell.focused();
            DOCTEST_REQUIRE(!now.empty());
            reached.insert(now);
        }
        auto buttons = pressable(harness);
        if (situation == Situation::Nothing) buttons.erase("viewport");  // there is a page in its place
        for (const char* wanted :
             {"prompt.source",     "prompt.sentence",     "prompt.mode.add",  "prompt.strength",
              "prompt.iterations", "prompt.seed",         "prompt.seed.lock", "prompt.learn",
              "prompt.advanced",   "prompt.locate",       "prompt.edit",      "prompt.cancel",
              "tool.brush",        "tool.lasso",          "tool.frame",       "tool.undo",
              "tool.screenshot",   "viewport.mode",       "viewport.compare", "viewport.tint",
              "viewport",          "tab.Prompt",          "tab.Labels",       "tab.History",
              "tab.Attention",     "job.pause",           "job.cancel",       "job.file.cancel",
              "result.apply",      "result.discard",      "start.open",       "start.sample",
              "start.recover.0",   "start.recent.0",      "toast.0.close",    "toast.0.button",
              "attention.view.2",  "attention.threshold", "attention.look",   "history.undo",
              "history.repeat.7"})
            if (buttons.contains(wanted))
                DOCTEST_CHECK_MESSAGE(reached.contains(wanted), std::string(wanted));
        DOCTEST_CHECK(reached.contains(situation == Situation::Nothing ? "start.sample" : "tool.brush"));
    }
}

DOCTEST_TEST_CASE("Enter and Space press what has the focus, Ctrl + Enter edits") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().request.prompt = "a bear wearing a red hat";
    DOCTEST_REQUIRE(tab_to(harness, "prompt.locate"));
    DOCTEST_CHECK(key_asks(harness, key::Enter, "locate"));
    DOCTEST_CHECK(key_asks(harness, key::Space, "locate"));
    harness.modifiers(false, true, false);
    DOCTEST_CHECK(key_asks(harness, key::Enter, "edit"));
    DOCTEST_CHECK(!harness.application.asked("locate"));
    harness.modifiers(false, false, false);
}

DOCTEST_TEST_CASE("arrows go to the control on that side, and step views again when the focus is left") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().request.prompt = "a bear wearing a red hat";
    DOCTEST_CHECK(key_asks(harness, key::Right, "look_through 0"));
    DOCTEST_REQUIRE(tab_to(harness, "prompt.locate"));
    DOCTEST_CHECK(!key_asks(harness, key::Right, "look_through"));
    DOCTEST_CHECK(harness.shell.focused() == "prompt.edit");
    harness.key(key::Left);
    DOCTEST_CHECK(harness.shell.focused() == "prompt.locate");
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.shell.focused().empty());
    DOCTEST_CHECK(key_asks(harness, key::Right, "look_through 1"));
    harness.key(key::Down);
    DOCTEST_CHECK(!harness.shell.focused().empty());
}

DOCTEST_TEST_CASE("Alt opens the menus, arrows go through them, Enter chooses") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().unsaved = false;  // else it asks first
    tap_alt(harness);
    DOCTEST_CHECK(harness.find("menu.open") != nullptr);
    harness.key(key::Right);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("menu.undo") != nullptr);
    harness.key(key::Left);
    harness.frame(3);
    harness.key(key::Down);
    DOCTEST_CHECK(key_asks(harness, key::Enter, "open_sample"));
    // Esc closes the menu and nothing else.
    tap_alt(harness);
    DOCTEST_CHECK(harness.find("menu.open") != nullptr);
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.find("menu.open") == nullptr);
    // So it does where the mouse opened it.
    harness.click("menu.File");
    DOCTEST_REQUIRE(harness.find("menu.open") != nullptr);
    harness.key(key::Escape);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("menu.open") == nullptr);
    // Alt held for something else opens nothing.
    harness.modifiers(false, false, true);
    harness.key('W');
    harness.modifiers(false, false, false);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("menu.open") == nullptr);
}

DOCTEST_TEST_CASE("F6 goes from area to area, P to the prompt") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    std::set<std::string> seen;
    for (int presses = 0; presses < 8; ++presses) {
        harness.key(key::F6);
        seen.insert(harness.shell.focused());
    }
    DOCTEST_CHECK(seen.size() >= 5);
    harness.key(key::Escape);
    harness.key(key::Escape);
    harness.key('P');
    harness.frame(2);
    harness.type("a green bear");
    DOCTEST_CHECK(harness.application.model().request.prompt == "a green bear");
}

DOCTEST_TEST_CASE(
    "a question is answered by keys: Enter takes what loses nothing, Tab reaches the others, Esc none") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    std::string answer;
    const auto ask = [&] {
        auto& question = harness.shell.state().question;
        question.title = "Really?";
        question.answers = {{"Lose it", true, [&answer] { answer = "lost"; }},
                            {"Keep it", false, [&answer] { answer = "kept"; }},
                            {"Later", false, [&answer] { answer = "later"; }}};
        question.pending = true;
        answer.clear();
        harness.frame(5);
    };
    ask();
    DOCTEST_CHECK(harness.shell.focused() == "question.1");
    harness.key(key::Enter);
    DOCTEST_CHECK(answer == "kept");
    ask();
    harness.key(key::Tab);
    DOCTEST_CHECK(harness.shell.focused() == "question.2");
    harness.key(key::Tab);  // stays within the question
    DOCTEST_CHECK(harness.shell.focused() == "question.0");
    harness.key(key::Space);
    DOCTEST_CHECK(answer == "lost");
    ask();
    harness.key(key::Escape);
    DOCTEST_CHECK(harness.find("question.0") == nullptr);
    DOCTEST_CHECK(answer.empty());
}

DOCTEST_TEST_CASE("the label's threshold moves by arrows") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    DOCTEST_REQUIRE(tab_to(harness, "labels.threshold"));
    const float before = harness.application.document().state().labels[0].threshold;
    harness.key(key::Right);
    DOCTEST_CHECK(harness.application.document().state().labels[0].threshold ==
                  doctest::Approx(before + 0.01));
    DOCTEST_CHECK(harness.shell.focused() == "labels.threshold");
    harness.key(key::Space);  // the mouse is somewhere else: nothing jumps there
    DOCTEST_CHECK(harness.application.document().state().labels[0].threshold ==
                  doctest::Approx(before + 0.01));
}

DOCTEST_TEST_CASE(
    "keys are chosen in their list: the command that had them is told, and they act once it is closed") {
    Harness harness({1920, 1080, 1, Situation::Located, false});
    const auto tool = [&] { return harness.shell.state().viewport.tool; };
    const auto choose = [&](const char* command, int code) {
        harness.modifiers(true, false, false);
        harness.key(key::F1);
        harness.modifiers(false, false, false);
        harness.frame(3);
        harness.click(fmt::format("keys.{}", command));
        harness.key(code);
        harness.frame(2);
    };
    choose("brush", 'R');  // Rectangle's
    DOCTEST_CHECK(harness.application.asked(
        "set_keymap {\"preset\":\"Splat\",\"keys\":{\"brush\":\"R\",\"rectangle\":\"\"}}"));
    DOCTEST_CHECK(harness.shell.state().keys.note == "R was \"Rectangle\", which has no key now");
    harness.key(key::Escape);
    DOCTEST_CHECK_FALSE(harness.shell.state().help_open);
    DOCTEST_CHECK(tool() == ui::Tool::Orbit);  // it was no command
    harness.key('R');
    DOCTEST_CHECK(tool() == ui::Tool::Brush);
    harness.key(key::Escape);
    harness.key('B');
    DOCTEST_CHECK(tool() == ui::Tool::Orbit);
    choose("lasso", 'W');
    DOCTEST_CHECK(harness.shell.state().keys.note == "W flies");
    harness.key(key::Escape);  // leaves the choice, not the list
    DOCTEST_CHECK(harness.shell.state().help_open);
    DOCTEST_CHECK_FALSE(harness.shell.state().keys.choosing);
    harness.click("keys.preset.Blender");
    harness.key(key::Escape);
    harness.key('L');
    DOCTEST_CHECK(tool() == ui::Tool::Lasso);
    harness.key('R');  // it was chosen: the convention does not take it away
    DOCTEST_CHECK(tool() == ui::Tool::Brush);
    harness.key('B');
    DOCTEST_CHECK(tool() == ui::Tool::Rectangle);
}

DOCTEST_TEST_CASE("as in Maya, Alt moves the camera with a tool in hand, too") {
    Harness harness({1280, 800, 1, Situation::Located, false});
    const auto drag_with_alt = [&](const char* preset) {
        harness.application.model().keymap = preset;
        harness.frame(2);
        harness.key('B');
        harness.application.calls.clear();
        const auto view = harness.rect("viewport");
        harness.modifiers(false, false, true);
        harness.drag({view.x + view.width * 0.4f, view.y + view.height * 0.4f},
                     {view.x + view.width * 0.6f, view.y + view.height * 0.5f});
        harness.modifiers(false, false, false);
        harness.frame(2);
        harness.key(key::Escape);
        return std::pair(harness.application.asked("set_camera"), harness.application.asked("select"));
    };
    DOCTEST_CHECK(drag_with_alt("{\"preset\":\"Maya\"}") == std::pair(true, false));
    DOCTEST_CHECK(drag_with_alt("") == std::pair(false, true));
}

DOCTEST_TEST_CASE("the list of keys tells about all of it") {
    std::string all;
    for (const auto& line : ui::KeyTable) all += std::string(line.keys) + "|";
    for (const char* wanted :
         {"Tab, Shift + Tab|", "Arrows|", "Space, Enter|", "F6, Shift + F6|", "Alt|", "|T|", "|P|", "F1|"})
        DOCTEST_CHECK_MESSAGE(all.find(wanted) != std::string::npos, std::string(wanted));
}

}  // namespace gse::test::keyboard_test
