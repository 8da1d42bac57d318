// Room of the picture, places of tooltips, and panels that stay where they are.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <imgui_internal.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::layout_test {
namespace {

constexpr int TooltipFrames = 40;  // of a mouse that rests: longer than a tooltip's delay

/// The shown tooltip; empty where there is none.
ui::Rect shown_tooltip() {
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (window->Active && !window->Hidden && (window->Flags & ImGuiWindowFlags_Tooltip) != 0)
            return {window->Pos.x, window->Pos.y, window->Size.x, window->Size.y, true};
    return {};
}

bool overlap(const ui::Rect& a, const ui::Rect& b) {
    constexpr float Touching = 1;  // px: edges that meet cover nothing
    return a.x + Touching < b.x + b.width && b.x + Touching < a.x + a.width &&
           a.y + Touching < b.y + b.height && b.y + Touching < a.y + a.height;
}

/// Buttons on the screen: those whose text is known.
std::vector<std::string> buttons_of(const Harness& harness) {
    std::vector<std::string> names;
    for (const auto& [name, rect] : harness.shell.widgets())
        if (rect.visible && (rect.text_width > 0 || name.starts_with("tool."))) names.push_back(name);
    return names;
}

}  // namespace

DOCTEST_TEST_CASE("the picture has two thirds of the window's height as it comes") {
    for (const auto& [width, height] : {std::pair{1280, 720}, {1920, 1080}, {2560, 1440}})
        for (const auto situation : {Situation::Scene, Situation::Located, Situation::Editing}) {
            Harness harness({width, height, 1, situation, false});
            DOCTEST_CAPTURE(height);
            DOCTEST_CHECK(harness.rect("viewport").height >= 2 * static_cast<float>(height) / 3);
        }
}

DOCTEST_TEST_CASE("a double click on a tab below the picture gives its panel half of the height, and back") {
    Harness harness({1280, 720, 1, Situation::Located, false});
    const float before = harness.rect("viewport").height;
    const auto twice = [&] {
        for (int click = 0; click < 2; ++click) harness.click("tab.Attention");
        harness.frame(30);  // no third click of it
    };
    twice();
    DOCTEST_CHECK(harness.rect("viewport").height < 0.7f * before);
    twice();
    DOCTEST_CHECK(harness.rect("viewport").height == before);
}

DOCTEST_TEST_CASE("what the artist has to answer below the picture is in sight without scrolling") {
    Harness failed({1280, 720, 1, Situation::Failed, false});
    for (const char* name : {"attention.anyway", "attention.by_hand"})
        DOCTEST_CHECK(failed.rect(name).visible);
    Harness waits({1280, 720, 1, Situation::Editing, false});
    waits.application.model().targets_wait = true;
    waits.frame(5);
    for (const char* name : {"targets.fit", "targets.0.drop", "targets.1.redo"})
        DOCTEST_CHECK(waits.rect(name).visible);
}

DOCTEST_TEST_CASE("curves and figures of the cost are folded away until they are asked for") {
    Harness harness({1920, 1080, 1, Situation::Editing, false});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    for (const char* hidden : {"progress.losses", "progress.norms", "progress.networks"})
        DOCTEST_CHECK(harness.find(hidden) == nullptr);
    // Buttons that stop a running edit stay in sight.
    for (const char* shown : {"progress.pause", "progress.cancel", "progress.snapshot"})
        DOCTEST_CHECK(harness.rect(shown).visible);
    harness.click("progress.cost");
    harness.frame(2);
    DOCTEST_CHECK(harness.find("progress.networks") != nullptr);
    harness.click("progress.cost");
    harness.click("progress.curves");
    harness.frame(2);
    DOCTEST_CHECK(harness.find("progress.losses") != nullptr);
    DOCTEST_CHECK(harness.find("progress.norms") != nullptr);
}

DOCTEST_TEST_CASE("a tooltip covers no button, whatever it explains") {
    for (const auto situation : {Situation::Located, Situation::ResultWaiting}) {
        Harness harness({1280, 720, 1, situation, false});
        for (const auto panel : {ui::PanelId::Prompt, ui::PanelId::Labels, ui::PanelId::Export,
                                 ui::PanelId::Progress, ui::PanelId::Attention}) {
            harness.shell.show(panel);
            harness.frame(3);
            int seen = 0;
            for (const auto& name : buttons_of(harness)) {
                const auto at = harness.middle(name);
                harness.move(at.x, at.y);
                harness.frame(TooltipFrames);
                const auto tip = shown_tooltip();
                if (!tip.visible) continue;
                ++seen;
                DOCTEST_CAPTURE(name);
                for (const auto& other : buttons_of(harness)) {
                    DOCTEST_CAPTURE(other);
                    DOCTEST_CHECK(!overlap(tip, harness.rect(other)));
                }
                DOCTEST_CHECK(tip.x >= 0);
                DOCTEST_CHECK(tip.y >= 0);
                DOCTEST_CHECK(tip.x + tip.width <= 1280);
                DOCTEST_CHECK(tip.y + tip.height <= 720);
            }
            DOCTEST_CHECK(seen > 5);
        }
    }
}

DOCTEST_TEST_CASE("nothing in Export moves while a file is written") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    const auto panel = harness.rect("panel.Export");
    harness.move(panel.x + panel.width / 2, panel.y + panel.height / 2);
    harness.wheel(-100);  // to its end
    std::vector<std::pair<std::string, ui::Rect>> before;
    for (const auto& [name, rect] : harness.shell.widgets())
        if (name.starts_with("export.")) before.emplace_back(name, rect);
    DOCTEST_REQUIRE(before.size() > 10);
    auto& job = harness.application.model().file_job;
    for (const bool running : {true, false}) {
        job.running = running;
        job.title = "Export edited.ply";
        harness.frame(10);
        for (const auto& [name, rect] : before) {
            const std::string widget = name;
            DOCTEST_CAPTURE(widget);
            DOCTEST_CAPTURE(running);
            DOCTEST_CHECK(harness.rect(widget).y == rect.y);
        }
    }
}

DOCTEST_TEST_CASE("on a large screen the sheets use the room, and all of a search is seen at once") {
    constexpr float LeastShare = 0.75f;  // of the panel's width, from the first picture to the last
    Harness harness({2560, 1440, 1, Situation::Editing, true});
    const auto spread = [&](const char* panel, const std::string& prefix) {
        const auto place = harness.rect(panel);
        float low = place.x + place.width, high = place.x;
        int seen = 0;
        for (const auto& [name, rect] : harness.shell.widgets()) {
            if (!name.starts_with(prefix) || !rect.visible) continue;
            ++seen;
            low = std::min(low, rect.x);
            high = std::max(high, rect.x + rect.width);
        }
        return std::pair{(high - low) / place.width, seen};
    };
    harness.shell.show(ui::PanelId::Attention);
    harness.frame(3);
    DOCTEST_CHECK(spread("panel.Attention", "attention.").first > LeastShare);
    DOCTEST_CHECK(spread("panel.Attention", "attention.view.").second == 24);
    DOCTEST_CHECK(harness.rect("attention.view.0").width > 60);
    harness.shell.show(ui::PanelId::Targets);
    harness.frame(3);
    const auto [share, shown] = spread("panel.Targets", "targets.");
    DOCTEST_CHECK(share > LeastShare);
    DOCTEST_CHECK(harness.rect("targets.0").width > 200);  // a pair, as high as the panel
    auto layout = ui::Layout::from_json(harness.shell.layout());
    layout.right_em = 70;
    harness.shell.set_layout(layout.to_json());
    harness.shell.show(ui::PanelId::Views);
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("views.row.1").y == harness.rect("views.row.0").y);  // beside each other
    DOCTEST_CHECK(spread("panel.Views", "views.").first > LeastShare);
}

DOCTEST_TEST_CASE("pictures of edits and results are shown large under the mouse") {
    constexpr float LeastLarge = 280;  // px: the change of a hat is seen
    Harness harness({1280, 720, 1, Situation::ResultWaiting, true});
    auto& model = harness.application.model();
    const auto picture = harness.application.document().state().stack.at(0).thumbnail;
    model.results = {{picture, 1}, {picture, 2}};
    harness.shell.show(ui::PanelId::History);
    harness.frame(5);
    for (const char* name : {"history.picture.7", "result.0"}) {
        DOCTEST_CAPTURE(name);
        const auto at = harness.middle(name);
        DOCTEST_CHECK(harness.rect(name).height > 70);
        harness.move(at.x, at.y);
        harness.frame(5);
        DOCTEST_CHECK(shown_tooltip().visible);
        DOCTEST_CHECK(shown_tooltip().width > LeastLarge);
    }
}

DOCTEST_TEST_CASE("a saved view is named when it is made, can be renamed, and shows its picture") {
    Harness harness({1280, 1440, 1, Situation::Located, true});
    auto state = harness.application.document().state();
    state.views.resize(3);
    harness.application.document().apply("Fewer", state);
    harness.shell.show(ui::PanelId::Views);
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("draw_view 0"));
    harness.application.calls.clear();
    harness.frame(10);
    DOCTEST_CHECK(!harness.application.asked("draw_view"));  // once is enough
    harness.click("views.add");
    harness.frame(3);
    DOCTEST_REQUIRE(harness.find("views.name") != nullptr);
    harness.type("from the left");
    harness.key(ui::key::Enter);
    DOCTEST_CHECK(harness.application.asked("rename_view 3 from the left"));
    harness.click("views.rename.1");
    harness.frame(3);
    harness.type("back");
    harness.key(ui::key::Escape);
    DOCTEST_CHECK(!harness.application.asked("rename_view 1"));
    DOCTEST_CHECK(harness.find("views.name") == nullptr);
}

DOCTEST_TEST_CASE("recent files are listed with their picture and their folder") {
    Harness harness({1280, 900, 1, Situation::Nothing, false});
    auto& model = harness.application.model();
    model.recoverable.clear();
    model.recent_pictures = {nullptr, std::make_shared<const Image>(32, 24, 3, 0.5f)};
    harness.frame(3);
    DOCTEST_CHECK(harness.find("start.recent.picture.0") == nullptr);
    DOCTEST_CHECK(harness.rect("start.recent.picture.1").visible);
    DOCTEST_CHECK(harness.rect("start.recent.1").height > 30);
    DOCTEST_CHECK(harness.asks("start.recent.2", "open /home/mira/scenes/kitchen.spz"));
}

DOCTEST_TEST_CASE("a screenshot is what the viewport shows unless the artist says otherwise") {
    Harness harness({1280, 1440, 1, Situation::Scene, false});
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    DOCTEST_CHECK(harness.application.model().exports.as_shown);
    const auto turntable = harness.rect("export.turntable").y, size = harness.rect("export.width").y;
    DOCTEST_CHECK(size > harness.rect("export.screenshot").y);  // that of films
    DOCTEST_CHECK(size < turntable);
    harness.click("export.as_shown");
    harness.frame(3);
    DOCTEST_CHECK(!harness.application.model().exports.as_shown);
    DOCTEST_CHECK(harness.rect("export.width").y < harness.rect("export.screenshot").y);
}

}  // namespace gse::test::layout_test
