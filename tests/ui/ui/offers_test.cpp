// Offers of the window, by clicks: to change what is there already, another variation, another format, and a
// scene that moved.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/io/formats/scene_formats.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/sentence.h"
#include "ui/state/state.h"

namespace gse::test::offers_test {
namespace {

constexpr int Wide = 1600, High = 1000;

/// A sentence that can be edited by, for a scene that has a hat already.
void say_second_hat(Harness& harness, const std::string& sentence) {
    auto& model = harness.application.model();
    model.request.source = "bear";
    model.request.prompt = sentence;
    model.request.target = "hat";
    model.scope.present = "hat";
    harness.frame(3);
}

}  // namespace

DOCTEST_TEST_CASE("a second hat is asked about: the one that is there is changed, or another is added") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    say_second_hat(harness, "a bear wearing a red hat");
    DOCTEST_CHECK_FALSE(harness.asks("prompt.edit", "edit"));
    harness.frame(2);
    DOCTEST_REQUIRE(harness.find("question.2") != nullptr);
    DOCTEST_CHECK(harness.shell.state().question.answers[0].text == "Change the hat");
    harness.click("question.2");  // cancelled
    DOCTEST_CHECK_FALSE(harness.application.asked("edit"));
    harness.click("prompt.edit");
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("question.1", "edit"));  // another
    DOCTEST_CHECK(request.source == "bear");
    harness.application.calls.clear();
    harness.shell.show(ui::PanelId::Prompt);
    harness.frame(3);
    harness.click("prompt.edit");
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("question.0", "edit"));
    DOCTEST_CHECK(request.source == "hat");
    DOCTEST_CHECK(request.prompt == "a red hat");
    DOCTEST_CHECK(request.target == "red");
}

DOCTEST_TEST_CASE("a second hat of which nothing is said: the sentence waits for what is to change") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& request = harness.application.model().request;
    say_second_hat(harness, "a bear wearing a hat");
    harness.click("prompt.edit");
    harness.frame(2);
    DOCTEST_CHECK_FALSE(harness.asks("question.0", "edit"));
    DOCTEST_CHECK(request.source == "hat");
    DOCTEST_CHECK(request.prompt.empty());
}

DOCTEST_TEST_CASE("the edit of a thing that a sentence would add is about it alone") {
    edit::EditRequest request;
    request.source = "bear";
    request.mode = "add";
    const auto changed = [&](const char* sentence, const char* thing) {
        request.prompt = sentence;
        const auto change = ui::as_change(request, thing);
        DOCTEST_CHECK(change.source == thing);
        DOCTEST_CHECK(change.mode == "auto");
        return change.prompt + "|" + change.target;
    };
    DOCTEST_CHECK(changed("a bear wearing a red hat", "hat") == "a red hat|red");
    DOCTEST_CHECK(changed("a bear with an orange woollen scarf", "scarf") ==
                  "an orange woollen scarf|orange woollen");
    DOCTEST_CHECK(changed("a bear wearing a hat", "hat") == "|");
}

DOCTEST_TEST_CASE("the panel says which label an edit uses where another one is shown, and offers one") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.prompt = "a golden bear";
    model.request.target = "golden";
    model.scope = {"bear", 120, true, false, "hat", ""};
    harness.frame(3);
    DOCTEST_REQUIRE(harness.find("prompt.scope") != nullptr);
    DOCTEST_CHECK(harness.asks("prompt.scope.other", "set_scope search"));
    model.request.source = "penguin";  // not known, and no label is named so
    model.request.prompt = "a golden penguin";
    model.scope = {"cut out", 120, false, false, "", ""};
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("prompt.scope.other", "set_scope label"));
}

DOCTEST_TEST_CASE("a scene is exported in a format from a menu, and its name follows") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& path = harness.application.model().exports.scene_path;
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    for (const auto& format : scene_formats()) {
        if (!format.writable() || format_written_to(path) == &format) continue;
        for (int notch = 0; notch < 60 && !harness.rect("export.format").visible; ++notch) {
            const auto panel = harness.rect("panel.Export");
            harness.move(panel.x + panel.width / 2, panel.y + panel.height / 2);
            harness.wheel(-2);
        }
        harness.click("export.format");
        harness.click("export.format." + format.name);
        harness.frame(2);
        DOCTEST_CHECK(path == "edited" + format.extensions.front());
        DOCTEST_CHECK(harness.find("export.kept") != nullptr);
    }
}

DOCTEST_TEST_CASE("variations of an applied edit stand under it, and a click exchanges them") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    const std::uint64_t id = model.document->state().stack.front().id;
    const auto picture = model.document->state().stack.front().thumbnail;
    harness.shell.show(ui::PanelId::History);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("history.variation.7.0") == nullptr);
    model.variations = {{id, {{picture, 3}, {picture, 4}, {picture, 5}}, 1}};
    harness.frame(2);
    DOCTEST_CHECK_FALSE(harness.asks("history.variation.7.1", "exchange_variation"));  // it is applied
    DOCTEST_CHECK(harness.asks("history.variation.7.2", "exchange_variation 7 2"));
}

DOCTEST_TEST_CASE("a project whose scene moved says so, and leads to the file") {
    for (const auto situation : {Situation::Nothing, Situation::Scene}) {
        Harness harness({Wide, High, 1, situation, false});
        auto& model = harness.application.model();
        model.unsaved = false;
        DOCTEST_CHECK(harness.find("lost.find") == nullptr);
        model.lost = {"/home/mira/bear.gsep", "bear.gsep", "/home/mira/scenes/scene.ply"};
        harness.frame(3);
        DOCTEST_REQUIRE(harness.find("lost.note") != nullptr);
        DOCTEST_CHECK(harness.asks("lost.close", "forget_lost_scene"));
        harness.click("lost.find");
        harness.frame(3);
        DOCTEST_CHECK(harness.shell.state().files.is_open());
        harness.key(ui::key::Escape);
        DOCTEST_CHECK_FALSE(harness.application.asked("find_scene"));
    }
}

}  // namespace gse::test::offers_test
