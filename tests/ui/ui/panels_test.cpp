// Every panel in every state, at every size and scale: nothing asserts, nothing is cut off, everything stays
// in its place.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <set>

#include "tests/ui/support/harness.h"

namespace gse::test::panels_test {
namespace {

constexpr std::array<Situation, 6> Situations{Situation::Nothing,       Situation::Scene,
                                              Situation::Located,       Situation::Editing,
                                              Situation::ResultWaiting, Situation::Failed};

struct Screen {
    int width, height;
    float scale;
};
constexpr std::array<Screen, 6> Screens{
    {{800, 600, 1}, {1280, 720, 1}, {1920, 1080, 1}, {1280, 720, 2}, {2560, 1440, 2}, {3840, 2160, 2}}};

/// Buttons whose text is wider than they are, and visible widgets outside the window.
void check_widgets(const Harness& harness, const Screen& screen) {
    for (const auto& [key, rect] : harness.shell.widgets()) {
        const auto& name = key;  // a structured binding cannot be captured
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK(rect.width >= 0);
        DOCTEST_CHECK(rect.height >= 0);
        if (rect.text_width > 0) DOCTEST_CHECK(rect.width + 0.5f >= rect.text_width);
        if (!rect.visible) continue;
        const float x = rect.x + rect.width / 2, y = rect.y + rect.height / 2;
        DOCTEST_CHECK(x >= 0);
        DOCTEST_CHECK(x <= static_cast<float>(screen.width));
        DOCTEST_CHECK(y >= 0);
        DOCTEST_CHECK(y <= static_cast<float>(screen.height));
    }
}

/// A button must not reach beyond the panel it is in: that is how text is cut off at the right.
void check_right_edges(const Harness& harness) {
    for (const auto& [key, rect] : harness.shell.widgets()) {
        const auto& name = key;
        if (!rect.visible || rect.text_width <= 0) continue;
        for (const char* panel : {"panel.Prompt", "panel.Labels", "panel.Scene", "panel.Models",
                                  "panel.History", "panel.Views", "panel.Export", "panel.Settings",
                                  "panel.Attention", "panel.Targets", "panel.Progress", "panel.Log"}) {
            const auto* place = harness.find(panel);
            if (place == nullptr) continue;
            const float x = rect.x + rect.width / 2, y = rect.y + rect.height / 2;
            const bool inside =
                x > place->x && x < place->x + place->width && y > place->y && y < place->y + place->height;
            if (!inside || name.starts_with("result.") || name.starts_with("toast.")) continue;
            DOCTEST_CAPTURE(name);
            DOCTEST_CAPTURE(panel);
            DOCTEST_CHECK(rect.x + rect.width <= place->x + place->width + 1);
        }
    }
}

}  // namespace

DOCTEST_TEST_CASE("every panel draws in every state, size and scale") {
    for (const auto& screen : Screens)
        for (const auto situation : Situations) {
            DOCTEST_CAPTURE(screen.width);
            DOCTEST_CAPTURE(screen.scale);
            DOCTEST_CAPTURE(static_cast<int>(situation));
            Harness harness({screen.width, screen.height, screen.scale, situation, false});
            for (std::size_t panel = 0; panel < ui::PanelCount; ++panel) {
                harness.shell.show(static_cast<ui::PanelId>(panel));
                harness.frame(3);
                DOCTEST_CAPTURE(ui::PanelTable[panel].name);
                DOCTEST_CHECK(harness.find(std::string("panel.") + ui::PanelTable[panel].name) != nullptr);
                check_widgets(harness, screen);
                check_right_edges(harness);
            }
            DOCTEST_CHECK(harness.rect("viewport").width > 100);
            DOCTEST_CHECK(harness.rect("viewport").height > 60);
        }
}

DOCTEST_TEST_CASE("panels can live in every area") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    for (std::size_t panel = 0; panel < ui::PanelCount; ++panel)
        for (const auto area : {ui::Area::Bottom, ui::Area::RightTop, ui::Area::RightBottom}) {
            auto layout = ui::Layout::from_json(harness.shell.layout());
            layout.move(static_cast<ui::PanelId>(panel), area);
            harness.shell.set_layout(layout.to_json());
            harness.frame(3);
            DOCTEST_CHECK(harness.find(std::string("panel.") + ui::PanelTable[panel].name) != nullptr);
            check_right_edges(harness);
        }
}

DOCTEST_TEST_CASE("a layout survives being saved, and nonsense does not hurt") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.click("tab.Models");
    const auto split = harness.middle("split.right");
    harness.drag(split, {split.x - 80, split.y});
    const std::string saved = harness.shell.layout();
    const float width = harness.rect("viewport").width;
    harness.shell.reset_layout();
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("viewport").width > width + 40);
    DOCTEST_CHECK(harness.find("panel.Models") == nullptr);
    harness.shell.set_layout(saved);
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("viewport").width == width);
    DOCTEST_CHECK(harness.find("panel.Models") != nullptr);
    DOCTEST_CHECK(harness.shell.layout() == saved);
    for (const char* text :
         {"", "no json", "[]",
          "{\"right_em\": 1e30, \"front\": [3, null], \"panels\": {\"Prompt\": 7, \"?\": {}}}",
          "{\"bottom_share\": \"x\", \"panels\": {\"Log\": {\"area\": 99}}}"}) {
        harness.shell.set_layout(text);
        harness.frame(3);
        DOCTEST_CHECK(harness.rect("viewport").width > 100);
    }
}

DOCTEST_TEST_CASE("names of widgets are there for scripts") {
    Harness harness({1920, 1080, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    for (const char* name :
         {"viewport", "tool.brush", "tool.rectangle", "tool.lasso", "labels.threshold", "history.undo",
          "menu.File", "attention.threshold", "tab.Export", "viewport.mode"})
        DOCTEST_CHECK_MESSAGE(harness.find(name) != nullptr, name);
    harness.shell.show(ui::PanelId::Prompt);
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    for (const char* name : {"prompt.sentence", "prompt.source", "prompt.locate", "prompt.edit",
                             "prompt.chip.1", "export.screenshot", "export.turntable"})
        DOCTEST_CHECK_MESSAGE(harness.find(name) != nullptr, name);
}

DOCTEST_TEST_CASE("nothing is sent while nobody does anything") {
    for (const auto situation : Situations) {
        Harness harness({1280, 720, 1, situation, false});
        harness.frame(30);
        harness.application.calls.clear();
        harness.frame(30);
        DOCTEST_CAPTURE(static_cast<int>(situation));
        for (const auto& call : harness.application.calls) DOCTEST_CHECK_MESSAGE(false, call);
        DOCTEST_CHECK(!harness.shell.animating());
    }
}

}  // namespace gse::test::panels_test
