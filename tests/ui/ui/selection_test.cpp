// Choosing splats by property, hiding them, comparing steps: what the window asks for and shows.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::selection_test {
namespace {

constexpr int Wide = 1920, High = 1080;

bool clicking_asks(Harness& harness, const std::string& widget, const std::string& call) {
    harness.application.calls.clear();
    harness.click(widget);
    harness.frame(2);
    return harness.application.asked(call);
}

}  // namespace

DOCTEST_TEST_CASE(
    "colours are adjusted while a slider moves, go back by its right click, and begin anew after another "
    "step") {
    Harness harness({Wide, 2 * High, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    harness.click("adjust.open");
    harness.frame(3);
    DOCTEST_CHECK(harness.find("adjust.scope") != nullptr);
    DOCTEST_CHECK_FALSE(harness.rect("adjust.reset").enabled);
    const auto slider = harness.rect("adjust.saturation");
    harness.drag({slider.x + slider.width / 3, slider.y + slider.height / 2},
                 {slider.x + 3, slider.y + slider.height / 2});
    DOCTEST_CHECK(harness.application.asked("adjust_colours saturation 0"));
    DOCTEST_CHECK(clicking_asks(harness, "adjust.reset", "adjust_colours "));
    harness.drag({slider.x + slider.width / 3, slider.y + slider.height / 2},
                 {slider.x + 3, slider.y + slider.height / 2});
    harness.frame(2);
    DOCTEST_CHECK(harness.shell.state().by_hand.adjust.values.saturation < 0.1);
    harness.application.model().adjusting = false;  // undone, or something else was done
    harness.frame(2);
    DOCTEST_CHECK(harness.shell.state().by_hand.adjust.values == ColourAdjustment{});
    harness.application.model().result_waiting = true;
    harness.frame(3);
    DOCTEST_CHECK(harness.find("adjust.saturation") == nullptr);
}

DOCTEST_TEST_CASE("select by property: seen while the section is open, used by its buttons, gone with it") {
    Harness harness({Wide, 2 * High, 1, Situation::Located, false});  // all of the panel is seen
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    auto& model = harness.application.model();
    DOCTEST_CHECK_FALSE(model.picked.shown);
    DOCTEST_CHECK(clicking_asks(harness, "pick.open", "pick_rows opacity below 0.10"));
    DOCTEST_CHECK(model.picked.shown);
    harness.frame(3);
    const auto before = model.picked.count;
    const auto bar = harness.rect("pick.threshold");
    harness.drag({bar.x + bar.width * 0.1f, bar.y + 8}, {bar.x + bar.width * 0.95f, bar.y + 8});
    DOCTEST_CHECK(harness.application.asked("pick_rows opacity below 0.95"));
    DOCTEST_CHECK(model.picked.count > before);  // at once, with every move
    DOCTEST_CHECK(clicking_asks(harness, "pick.within", "pick_rows opacity below 0.95 within"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.side.Above", "pick_rows opacity above 0.95 within"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.property.Size", "pick_rows size above 5 % within"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.property.Floaters",
                                "pick_rows above 4.0 times the usual distance within"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.property.Colour", "pick_rows colour within 15 within"));
    DOCTEST_CHECK(harness.find("pick.colour") != nullptr);
    DOCTEST_CHECK(clicking_asks(harness, "pick.property.Opacity",
                                "pick_rows opacity above 0.95 within"));  // as it was left
    model.picked.count = 7;
    harness.frame(2);
    DOCTEST_CHECK(clicking_asks(harness, "pick.new", "use_picked 0"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.add", "use_picked 1"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.remove", "use_picked 2"));
    DOCTEST_CHECK(clicking_asks(harness, "pick.delete", "use_picked 3"));
    model.picked.count = 0;
    harness.frame(2);
    for (const char* name : {"pick.new", "pick.add", "pick.remove", "pick.delete"})
        DOCTEST_CHECK_FALSE(harness.rect(name).enabled);
    harness.application.calls.clear();
    harness.shell.show(ui::PanelId::Prompt);  // another tab: nothing is tinted that nobody can change
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("drop_picked"));
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    DOCTEST_CHECK(model.picked.shown);
    DOCTEST_CHECK(clicking_asks(harness, "pick.open", "drop_picked"));
}

DOCTEST_TEST_CASE("hide and isolate: by key and button, with a note as long as something is hidden") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    auto& application = harness.application;
    const auto key_asks = [&](int index, const std::string& call) {
        application.calls.clear();
        harness.key(index);
        return application.asked(call);
    };
    DOCTEST_CHECK(key_asks('H', "hide_label"));
    DOCTEST_CHECK(key_asks('I', "isolate_label"));
    DOCTEST_CHECK(harness.find("hidden.note") == nullptr);
    harness.modifiers(true, false, false);
    DOCTEST_CHECK(key_asks('H', "show_hidden"));
    harness.modifiers(false, false, false);
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    DOCTEST_CHECK(clicking_asks(harness, "labels.hide", "hide_label"));
    DOCTEST_CHECK(clicking_asks(harness, "labels.isolate", "isolate_label"));
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("export.visible_only") == nullptr);
    application.model().hidden = 1234;
    harness.frame(3);
    DOCTEST_CHECK(harness.find("hidden.note") != nullptr);
    DOCTEST_CHECK(clicking_asks(harness, "hidden.show", "show_hidden"));
    DOCTEST_CHECK_FALSE(application.model().exports.visible_only);
    harness.click("export.visible_only");
    harness.frame(2);
    DOCTEST_CHECK(application.model().exports.visible_only);  // only when it is said
    Harness empty({Wide, High, 1, Situation::Nothing, false});
    empty.key('H');
    empty.key('I');
    DOCTEST_CHECK_FALSE(empty.application.asked("hide_label"));  // nothing is open
    DOCTEST_CHECK_FALSE(empty.application.asked("isolate_label"));
}

DOCTEST_TEST_CASE("history: any step but the one that is shown can be compared with") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::History);
    harness.frame(3);
    const auto& document = harness.application.document();
    DOCTEST_REQUIRE(document.names().size() > 1);
    const auto now = std::to_string(document.position());
    DOCTEST_CHECK_FALSE(harness.rect("history.compare." + now).enabled);
    DOCTEST_CHECK(clicking_asks(harness, "history.compare.0", "compare_with 0"));
    harness.application.model().compared_revision = document.revision_at(0);
    harness.frame(2);
    DOCTEST_CHECK(clicking_asks(harness, "history.compare.0", "compare_with 0"));  // takes it back
}

}  // namespace gse::test::selection_test
