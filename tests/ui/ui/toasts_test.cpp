// Toasts never lie over anything that can be pressed, at any size and in any state.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/ui/support/harness.h"

namespace gse::test::toasts_test {
namespace {

struct Screen {
    int width, height;
    float scale;
};
constexpr std::array<Screen, 7> Screens{{{700, 500, 1},
                                         {800, 600, 1},
                                         {1280, 720, 1},
                                         {1600, 900, 1},
                                         {1920, 1080, 1},
                                         {1280, 720, 2},
                                         {2560, 1440, 2}}};

const std::string Long(
    "The cameras beside the scene cannot be used: the file holds 24 cameras of an unknown model; write them "
    "as "
    "cameras.json, or let the views be an orbit around what is labelled. "
    "(/home/mira/scenes/garden/cameras.txt)");

bool overlap(const ui::Rect& a, const ui::Rect& b) {
    const float edge = 1;
    return a.x + edge < b.x + b.width && b.x + edge < a.x + a.width && a.y + edge < b.y + b.height &&
           b.y + edge < a.y + a.height;
}

/// Toasts that are drawn.
std::size_t check_free(const Harness& harness) {
    std::size_t drawn = 0;
    const auto& widgets = harness.shell.widgets();
    for (const auto& [key, toast] : widgets) {
        if (!key.starts_with("toast.") || key.find('.', 6) != std::string::npos) continue;
        ++drawn;
        const auto viewport = harness.rect("viewport");
        DOCTEST_CHECK(toast.y >= viewport.y);
        for (const auto& [other, rect] : widgets) {
            const auto &name = other, &of = key;
            // What the start page has scrolled away is cut off at its edge.
            if (name.starts_with("start.") && name != "start.page") continue;
            if (name.starts_with(of + ".") || name == of || name == "viewport" ||
                name.starts_with("panel.") || !rect.visible)
                continue;
            DOCTEST_CAPTURE(of);
            DOCTEST_CAPTURE(name);
            DOCTEST_CHECK(!overlap(toast, rect));
        }
    }
    return drawn;
}

}  // namespace

DOCTEST_TEST_CASE("no toast lies over a button or another toast") {
    for (const auto& screen : Screens)
        for (const auto situation :
             {Situation::Nothing, Situation::Scene, Situation::Editing, Situation::ResultWaiting}) {
            DOCTEST_CAPTURE(screen.width);
            DOCTEST_CAPTURE(screen.scale);
            DOCTEST_CAPTURE(static_cast<int>(situation));
            Harness harness({screen.width, screen.height, screen.scale, situation, false});
            auto& model = harness.application.model();
            model.toasts = {{Long, true, 1, {}},
                            {"Wrote turntable.mp4", false, 1, {}},
                            {Long + " again", false, 1, "Show"},
                            {"Up axis guessed from 24 cameras", false, 1, "Flip"}};
            harness.frame(3);
            std::size_t drawn = check_free(harness);
            if (harness.rect("viewport").height > 20 * 15 * screen.scale) DOCTEST_CHECK(drawn >= 2);
            model.comparison = ui::Comparison::Wipe;
            model.view.wipe = 0.95f;
            model.recoverable.push_back(recovery_of("garden"));
            harness.frame(3);
            check_free(harness);
            model.toasts.resize(1);
            harness.frame(3);
            drawn = check_free(harness);
            if (situation == Situation::Nothing) DOCTEST_CHECK(drawn == 1);
        }
}

DOCTEST_TEST_CASE("no line of a toast ends within a number") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    const std::string number = "1,234,567.891,011,121";
    std::string line = "A line of";
    const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
    const float edges = 2 * ImGui::GetStyle().WindowPadding.x, rounding = 2;
    int broken = 0;
    for (int words = 0; words < 12; ++words) {
        line += " splat";
        model.toasts = {{line + " " + number, false, 1, {}}};
        harness.frame(3);
        const auto toast = harness.rect("toast.0");
        const float longest = std::max(width_of(line), width_of(number)),
                    whole = width_of(line + " " + number);
        const float text = toast.width - edges;
        if (text >= whole) continue;  // it has one line
        ++broken;
        if (text >= width_of(line)) DOCTEST_CHECK(text <= longest + rounding);
    }
    DOCTEST_CHECK(broken > 3);
}

DOCTEST_TEST_CASE("a dialog lies above the toasts") {
    Harness harness({1280, 720, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    harness.shell.request_quit();  // asks: there is unsaved work
    harness.frame(3);
    for (int i = 0; i < 4; ++i) model.toasts.push_back({Long + std::to_string(i), true, 1, {}});
    harness.frame(3);
    harness.application.calls.clear();
    harness.click("question.1");
    DOCTEST_CHECK(harness.application.asked("quit"));
}

}  // namespace gse::test::toasts_test
