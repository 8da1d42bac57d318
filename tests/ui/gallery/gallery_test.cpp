// Pictures of the window in every state, size and scale, drawn without a device. At 1280x720 each is held
// against its baseline.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <functional>

#include "engine/io/image/image_file.h"
#include "tests/image_baseline.h"
#include "tests/test_paths.h"
#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"

namespace gse::test::gallery_test {
namespace {

std::filesystem::path gallery_folder() {
    const auto folder = binary_folder() / "ui_gallery";
    std::filesystem::create_directories(folder);
    return folder;
}

constexpr int KeptPixels = 4;  // sides of the squares of a baseline: small in the repository, still readable

struct Shot {
    const char* name;
    Situation situation;
    std::vector<ui::PanelId> panels;
    std::function<void(Harness&)> act = {};
    bool held = true;  // against a baseline: nothing in it depends on the machine's folders
};

const std::vector<Shot>& shots() {
    using ui::PanelId;
    static const std::vector<Shot> All{
        {"start", Situation::Nothing, {}},
        {"scene", Situation::Scene, {PanelId::Prompt, PanelId::Views, PanelId::Log}},
        {"located", Situation::Located, {PanelId::Labels, PanelId::History, PanelId::Attention}},
        {"editing", Situation::Editing, {PanelId::Prompt, PanelId::History, PanelId::Progress}},
        {"targets", Situation::Editing, {PanelId::Prompt, PanelId::History, PanelId::Targets}},
        {"result", Situation::ResultWaiting, {PanelId::Scene, PanelId::Export, PanelId::Progress}},
        {"help",
         Situation::Scene,
         {},
         [](Harness& harness) {
             harness.modifiers(true, false, false);
             harness.key(ui::key::F1);
             harness.modifiers(false, false, false);
         }},
        {"files",
         Situation::Scene,
         {},
         [](Harness& harness) {
             harness.application.model().recent = {
                 (source_folder() / "assets/scenes/bear/scene.ply").string()};
             harness.modifiers(false, true, false);
             harness.key('O');
             harness.modifiers(false, false, false);
             harness.frame(3);
             harness.key(ui::key::Down);
         },
         false},
        {"settings",
         Situation::Scene,
         {PanelId::Prompt, PanelId::Settings},
         [](Harness& harness) {
             harness.click("prompt.advanced");
             harness.frame(2);
             if (harness.find("prompt.group.Localization") != nullptr)
                 harness.click("prompt.group.Localization");
             auto layout = ui::Layout::from_json(harness.shell.layout());
             layout.right_split = 0.8f;
             harness.shell.set_layout(layout.to_json());
             harness.shell.show(PanelId::Settings);
         }},
        {"brush",
         Situation::Located,
         {PanelId::Labels, PanelId::Export},
         [](Harness& harness) {
             harness.key('B');
             const auto view = harness.rect("viewport");
             harness.move(view.x + view.width * 0.45f, view.y + view.height * 0.5f);
             harness.press();
             harness.move(view.x + view.width * 0.55f, view.y + view.height * 0.45f);
         }},
        {"menu", Situation::Located, {PanelId::Scene}, [](Harness& harness) { harness.click("menu.View"); }},
        {"question",
         Situation::Editing,
         {PanelId::Attention},
         [](Harness& harness) { harness.click("job.cancel"); }},
        {"failed", Situation::Failed, {PanelId::Models, PanelId::Settings, PanelId::Log}},
    };
    return All;
}

void take(const Shot& shot, int width, int height, float scale) {
    Harness harness({width, height, scale, shot.situation, true});
    for (const auto panel : shot.panels) harness.shell.show(panel);
    if (shot.situation == Situation::ResultWaiting)
        harness.application.model().comparison = ui::Comparison::Wipe;
    if (shot.situation == Situation::Editing) harness.application.model().view.show_views = true;
    harness.frame(6);
    if (shot.act) shot.act(harness);
    harness.frame(3);
    const Image picture = harness.picture();
    float brightest = 0;
    for (const float value : picture.data) brightest = std::max(brightest, value);
    DOCTEST_CHECK(brightest > 0.5f);
    write_png(gallery_folder() / fmt::format("{}_{}x{}_{}.png", shot.name, width, height, scale), picture);
    if (width == 1280 && scale == 1 && shot.held)
        check_baseline(std::string("window/") + shot.name, picture, WindowTolerance, KeptPixels);
}

}  // namespace

DOCTEST_TEST_CASE("the window in every state") {
    const char* only = std::getenv("GSE_GALLERY");
    for (const auto& shot : shots()) {
        if (only != nullptr && std::string(only).find(shot.name) == std::string::npos) continue;
        take(shot, 1280, 720, 1);
        if (std::getenv("GSE_GALLERY_ALL") == nullptr) continue;
        take(shot, 1920, 1080, 1);
        take(shot, 2560, 1440, 2);
        take(shot, 800, 600, 1);
        take(shot, 1280, 720, 2);
    }
}

}  // namespace gse::test::gallery_test
