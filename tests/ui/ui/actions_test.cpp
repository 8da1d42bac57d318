// Clicks and keys on the window ask the application for the right things.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/format.h>

#include "tests/ui/support/harness.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"

namespace gse::test::actions_test {
namespace {

namespace key = ui::key;
constexpr int Wide = 1920, High = 1080;

}  // namespace

DOCTEST_TEST_CASE("the start page opens, recovers and discards") {
    Harness harness({Wide, High, 1, Situation::Nothing, false});
    DOCTEST_CHECK(harness.asks("start.sample", "open_sample"));
    DOCTEST_CHECK(
        harness.asks("start.recover.0", "recover /home/mira/.local/state/gseditpro/autosave/garden.gsep"));
    DOCTEST_CHECK(harness.asks("start.recent.1", "open /home/mira/scenes/b\xC3\xA4r im Wald.gsep"));
    harness.click("start.discard.0");
    DOCTEST_CHECK(!harness.application.asked("discard_recovery"));
    DOCTEST_CHECK(harness.asks("question.0", "discard_recovery"));
}

DOCTEST_TEST_CASE("the start page's sentences open the sample and are what the edit is asked for") {
    Harness harness({Wide, High, 1, Situation::Nothing, false});
    harness.application.model().request.target = "crown";
    harness.application.model().request.mode = "add";
    DOCTEST_CHECK(harness.asks("start.try.2", "open_sample"));
    const auto& request = harness.application.model().request;
    DOCTEST_CHECK(request.source == "bear");
    DOCTEST_CHECK(request.prompt == "a yellow mushroom on the grass");
    DOCTEST_CHECK(request.target == "");
    DOCTEST_CHECK(request.mode == "auto");
}

DOCTEST_TEST_CASE("labels: threshold, names, operations") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::Labels);
    harness.frame(3);
    const auto bar = harness.rect("labels.threshold");
    harness.drag({bar.x + bar.width * 0.5f, bar.y + 10}, {bar.x + bar.width * 0.9f, bar.y + 10});
    DOCTEST_CHECK(harness.application.asked("set_label_threshold 0."));
    DOCTEST_CHECK(harness.application.calls.back().ends_with(" end"));  // the step of undo ends with the drag
    DOCTEST_CHECK(harness.application.document().state().labels[0].threshold ==
                  doctest::Approx(0.9).epsilon(0.01));
    DOCTEST_CHECK(harness.asks("labels.row.1", "set_active_label 1"));
    DOCTEST_CHECK(harness.asks("labels.grow", "grow_label 1"));
    DOCTEST_CHECK(harness.asks("labels.shrink", "grow_label -1"));
    DOCTEST_CHECK(harness.asks("labels.invert", "invert_label"));
    DOCTEST_CHECK(harness.asks("labels.clear", "clear_label"));
    DOCTEST_CHECK(harness.asks("labels.delete_splats", "delete_labelled_splats"));
    DOCTEST_CHECK(harness.asks("labels.add", "add_label label"));
    harness.key(key::Escape);
    harness.click("labels.rename.0");
    harness.frame(3);
    harness.type("teddy");
    harness.application.calls.clear();
    harness.key(key::Enter);
    DOCTEST_CHECK(harness.application.asked("rename_label 0 teddy"));
    // The fake deletes at once: the frame must not stumble over it.
    DOCTEST_CHECK(harness.asks("labels.delete.1", "delete_label 1"));
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("labels.delete.0", "delete_label 0"));
    harness.frame(3);
    DOCTEST_CHECK(!harness.rect("labels.grow").enabled);
}

DOCTEST_TEST_CASE("attention: masks that are older than the label say so") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.shell.show(ui::PanelId::Attention);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("attention.corrected") == nullptr);
    DOCTEST_CHECK(harness.find("attention.picture.Voted mask") != nullptr);
    harness.application.model().attention_corrected = true;
    harness.frame(2);
    DOCTEST_CHECK(harness.find("attention.corrected") != nullptr);
    DOCTEST_CHECK(harness.find("attention.picture.Voted mask") == nullptr);
}

DOCTEST_TEST_CASE("attention: choosing a view and the threshold") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.click("attention.view.3");
    const auto bar = harness.rect("attention.threshold");
    harness.drag({bar.x + bar.width * 0.35f, bar.y + 8}, {bar.x + bar.width * 0.6f, bar.y + 8});
    DOCTEST_CHECK(harness.application.asked("set_attention_threshold 0.6"));
    const auto& calls = harness.application.calls;
    DOCTEST_CHECK(std::count_if(calls.begin(), calls.end(),
                                [](const auto& call) { return call.ends_with(" end"); }) == 1);
    DOCTEST_CHECK(harness.application.model().attention_threshold == doctest::Approx(0.6).epsilon(0.05));
    DOCTEST_CHECK(harness.asks("attention.look", "set_camera"));
}

DOCTEST_TEST_CASE(
    "attention: a thumbnail turns the camera there, with its map over the picture; Ctrl leaves the view "
    "out") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    auto& over = harness.shell.state().attention.over;
    DOCTEST_CHECK(harness.find("viewport.evidence") == nullptr);
    harness.click("attention.view.3");
    harness.frame(3);
    const Camera& wanted = harness.application.model().attention[3].camera;
    DOCTEST_CHECK(length(harness.application.model().camera.centre() - wanted.centre()) < 1e-6);
    const auto shown = harness.rect("viewport.evidence");
    DOCTEST_CHECK(shown.width / shown.height ==
                  doctest::Approx(static_cast<double>(wanted.width) / wanted.height).epsilon(0.02));
    DOCTEST_CHECK(over == ui::Over::Attention);
    harness.key('M');
    DOCTEST_CHECK(over == ui::Over::Mask);
    harness.key('M');
    harness.frame(2);
    DOCTEST_CHECK(harness.find("viewport.evidence") == nullptr);
    harness.key('M');
    harness.frame(2);
    DOCTEST_CHECK(over == ui::Over::Attention);
    harness.key(ui::key::Right);  // to the next view of the search
    harness.frame(3);
    DOCTEST_CHECK(harness.shell.state().attention.chosen == 4);
    DOCTEST_CHECK(harness.find("viewport.evidence") != nullptr);
    harness.modifiers(false, true, false);
    harness.click("attention.view.3");
    DOCTEST_CHECK(harness.application.asked("leave_out_view 3 out"));
    harness.click("attention.view.3");
    DOCTEST_CHECK(harness.application.asked("leave_out_view 3 back"));
    harness.modifiers(false, false, false);
    DOCTEST_CHECK(harness.shell.state().attention.chosen == 4);
    DOCTEST_CHECK(harness.asks("evidence.votes", "leave_out_view 4 out"));
    harness.key(ui::key::Escape);
    harness.frame(2);
    DOCTEST_CHECK(harness.find("evidence.votes") == nullptr);
    DOCTEST_CHECK(harness.asks("attention.votes", "leave_out_view 4 back"));
    harness.application.model().attention_arriving = true;  // nothing is voted while the search looks
    harness.application.model().attention[2] = {};
    harness.frame(2);
    DOCTEST_CHECK(harness.find("attention.arriving") != nullptr);
    DOCTEST_CHECK_FALSE(harness.rect("attention.votes").enabled);
    const auto calls = harness.application.calls.size();
    harness.click("attention.view.2");
    DOCTEST_CHECK(harness.application.calls.size() == calls);  // it has no camera yet
}

DOCTEST_TEST_CASE("progress: pause, snapshots, cancel") {
    Harness harness({Wide, High, 1, Situation::Editing, false});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("progress.pause", "pause on"));
    harness.application.model().job.paused = true;
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("job.pause", "pause off"));
    const auto bar = harness.rect("progress.snapshot");
    harness.drag({bar.x + bar.width - 8, bar.y + 8}, {bar.x + 8, bar.y + 8});
    DOCTEST_CHECK(harness.application.asked("show_snapshot 0"));
    // What the branch gives up is asked about, whether the edit still runs or waits to be applied.
    const int iteration = harness.application.model().snapshots.back().iteration;
    harness.application.model().request.method = "sds";
    harness.application.model().request.iterations = iteration + 100;
    harness.frame(2);
    DOCTEST_CHECK(!harness.asks("progress.branch", "branch_from_snapshot"));
    DOCTEST_CHECK(harness.asks("question.0", "branch_from_snapshot"));
    harness.application.model().request.iterations = 1;
    harness.frame(2);
    DOCTEST_CHECK_FALSE(harness.rect("progress.branch").enabled);  // nothing would be left to do
    // 33 s of work: asked first.
    DOCTEST_CHECK(!harness.asks("job.cancel", "cancel"));
    DOCTEST_CHECK(harness.asks("question.0", "cancel"));
    harness.application.model().job.seconds = 3;
    DOCTEST_CHECK(harness.asks("job.cancel", "cancel"));
    DOCTEST_CHECK(harness.key_asks(key::Escape, "cancel"));
    DOCTEST_CHECK(harness.asks("job.file.cancel", "cancel_file_job"));
}

DOCTEST_TEST_CASE("a result that waits lies behind the last snapshot, which can be taken in its place") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.rect("progress.take").enabled);  // it is the result
    DOCTEST_CHECK_FALSE(harness.rect("progress.newest").enabled);
    auto& model = harness.application.model();
    const int last = static_cast<int>(model.snapshots.size()) - 1;
    const auto bar = harness.rect("progress.snapshot");
    const float step = bar.width / static_cast<float>(last + 2);
    harness.drag({bar.x + bar.width - 8, bar.y + 8}, {bar.x + bar.width - 8 - step, bar.y + 8});
    DOCTEST_CHECK(harness.application.asked(fmt::format("show_snapshot {}", last)));
    model.shown_snapshot = last;
    harness.frame(3);
    DOCTEST_CHECK(
        harness.asks("progress.take", fmt::format("take_snapshot {}", model.snapshots.back().iteration)));
    DOCTEST_CHECK(harness.asks("progress.newest", "show_snapshot -1"));
}

DOCTEST_TEST_CASE("a result that waits is applied or discarded") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    DOCTEST_CHECK(harness.asks("result.apply", "apply_result"));
    DOCTEST_CHECK(harness.asks("result.discard", "discard_result"));
    DOCTEST_CHECK(harness.asks("result.compare", "set_comparison 1"));
    DOCTEST_CHECK(!harness.rect("prompt.edit").enabled);
}

DOCTEST_TEST_CASE("one more result is asked for, and of several each can be shown") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    DOCTEST_CHECK(harness.asks("result.another", "another_result"));
    DOCTEST_CHECK(harness.find("result.0") == nullptr);  // one needs no choice
    harness.application.model().results = {
        {nullptr, 4}, {std::make_shared<const Image>(8, 8, 3), 5}, {nullptr, 6}};
    harness.application.model().shown_result = 2;
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("result.0", "show_result 0"));
    DOCTEST_CHECK(harness.asks("result.1", "show_result 1"));
    const auto first = harness.rect("result.0"), second = harness.rect("result.1"),
               apply = harness.rect("result.apply");
    DOCTEST_CHECK(first.x + first.width <= second.x);
    DOCTEST_CHECK(first.y + first.height <= apply.y);
}

DOCTEST_TEST_CASE("where Apply is decided stands what it took and what it left alone") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    for (const char* name : {"result.time", "result.proof"}) {
        DOCTEST_REQUIRE(harness.find(name) != nullptr);
        DOCTEST_CHECK(harness.rect(name).visible);
        const auto words = harness.rect(name), compare = harness.rect("result.compare");
        DOCTEST_CHECK((words.x + words.width <= compare.x ||
                       words.y + words.height <= compare.y));  // beside them, or above where that is too wide
    }
    DOCTEST_CHECK(harness.rect("result.apply").y >
                  harness.rect("viewport").y + harness.rect("viewport").height * 3 / 4);  // not over a hat
}

DOCTEST_TEST_CASE("the verdict on a result stands above its buttons; where it warns, Apply says so") {
    Harness harness({Wide, High, 1, Situation::ResultWaiting, false});
    auto& verdict = harness.application.model().verdict;
    verdict.text = "The model's pictures show the edit (score 0.41).";
    harness.frame(3);
    DOCTEST_REQUIRE(harness.find("result.verdict") != nullptr);
    const auto said = harness.rect("result.verdict"), apply = harness.rect("result.apply");
    DOCTEST_CHECK(said.visible);
    DOCTEST_CHECK(said.y + said.height <= apply.y);
    verdict.text = "The model's pictures hardly show \"a bear with wings\" (score 0.02).";
    verdict.warns = true;
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("result.verdict").y < said.y);         // with what to try below it
    DOCTEST_CHECK(harness.rect("result.apply").width > apply.width);  // "Apply anyway"
    DOCTEST_CHECK(harness.asks("result.apply", "apply_result"));
}

DOCTEST_TEST_CASE("history: stack and steps") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    DOCTEST_CHECK(harness.asks("history.enabled.7", "set_edit_enabled 7 off"));
    DOCTEST_CHECK(harness.asks("history.repeat.7", "repeat_edit 7"));
    harness.shell.show(ui::PanelId::History);  // repeating shows the prompt
    harness.frame(3);
    const auto bar = harness.rect("history.strength.7");
    harness.drag({bar.x + bar.width * 0.5f, bar.y + 8}, {bar.x + bar.width * 0.8f, bar.y + 8});
    DOCTEST_CHECK(harness.application.asked("set_edit_strength 7 1."));
    DOCTEST_CHECK(harness.application.calls.back().ends_with(" end"));  // the step of undo ends with the drag
    DOCTEST_CHECK(harness.asks("history.delete.7", "delete_edit 7"));
    DOCTEST_CHECK(harness.asks("history.undo", "undo"));
    DOCTEST_CHECK(harness.asks("history.redo", "redo"));
    DOCTEST_CHECK(harness.asks("history.step.0", "go_to 0"));
    harness.modifiers(false, true, false);
    DOCTEST_CHECK(harness.key_asks('Z', "undo"));
    DOCTEST_CHECK(harness.key_asks('Y', "redo"));
    harness.modifiers(true, true, false);
    DOCTEST_CHECK(harness.key_asks('Z', "redo"));
}

DOCTEST_TEST_CASE("views, export, scene, models, settings") {
    Harness harness({Wide, High * 3, 1, Situation::Scene, false});
    harness.shell.show(ui::PanelId::Views);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("views.row.2", "look_through 2"));
    DOCTEST_CHECK(harness.asks("views.next", "look_through 3"));
    DOCTEST_CHECK(harness.asks("views.add", "add_view"));
    DOCTEST_CHECK(harness.asks("views.delete.1", "delete_view 1"));
    harness.shell.show(ui::PanelId::Export);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("export.size.4K", "set_exports"));
    DOCTEST_CHECK(harness.application.model().exports.width == 3840);
    DOCTEST_CHECK(harness.asks("export.screenshot", "export_picture"));
    DOCTEST_CHECK(harness.asks("export.turntable", "export_turntable"));
    DOCTEST_CHECK(harness.asks("export.scene", "export_scene"));
    DOCTEST_CHECK(harness.asks("export.viewpoints", "export_viewpoints"));
    harness.application.model().exports.scene_path = "out.sog";
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("export.scene", "export_scene"));
    harness.application.model().exports.scene_path = "out.spz";
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("export.spz_version.4", "set_exports"));
    DOCTEST_CHECK(harness.application.model().exports.format_choices["spz_version"] == 4);
    harness.application.model().exports.film_path = "film.avi";
    harness.application.model().exports.picture_path.clear();
    harness.frame(2);
    DOCTEST_CHECK(!harness.rect("export.turntable").enabled);
    DOCTEST_CHECK(!harness.rect("export.screenshot").enabled);
    harness.shell.show(ui::PanelId::Scene);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("scene.up.z", "set_up_axis z"));
    auto& document = harness.application.document();
    auto upright = document.state();
    upright.info.up = {0, 0, 1}, upright.info.up_known = true;
    document.apply("Up axis", upright);
    harness.frame(3);
    DOCTEST_CHECK(!harness.asks("scene.up.z", "set_up_axis"));  // it is chosen, and shown to be
    DOCTEST_CHECK(harness.asks("scene.up.-z", "set_up_axis -z"));
    DOCTEST_CHECK(harness.find("up.note") == nullptr);
    upright.info.up_known = false, upright.info.up_unsure = true;
    document.apply("Up axis", upright);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("up.note") != nullptr);
    DOCTEST_CHECK(harness.asks("up.-x", "set_up_axis -x"));
    DOCTEST_CHECK(harness.asks("up.z", "set_up_axis z"));  // what is taken can be confirmed
    harness.shell.show(ui::PanelId::Models);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("models.use.1", "choose_model /home/mira/ComfyUI"));
    DOCTEST_CHECK(!harness.asks("models.use.2", "choose_model"));
    DOCTEST_CHECK(!harness.rect("models.lora.add").enabled);  // nothing was typed
    harness.application.model().loras = {{"/loras/style.safetensors", "style", 0.5}};
    harness.frame(2);
    DOCTEST_CHECK(harness.asks("models.lora.remove.0", "remove_lora 0"));
    harness.shell.show(ui::PanelId::Prompt);
    for (const bool editor : {false, true}) {
        harness.application.model().edits_by_instruction = editor;
        harness.frame(3);
        DOCTEST_CHECK((harness.find("prompt.instruction") != nullptr) == editor);
    }
    harness.shell.show(ui::PanelId::Settings);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("settings.show_bounds", "set_view_settings"));
    DOCTEST_CHECK(harness.application.model().view.show_bounds);
    DOCTEST_CHECK(harness.asks("settings.scale.200 %", "set_ui_scale 2.00"));
    harness.application.model().ui_scale = 1;
    harness.application.model().cache_bytes = 3000000;
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("settings.cache.128 MB", "set_cache_mb 128"));
    DOCTEST_CHECK(harness.asks("settings.clear_cache", "clear_cache"));
}

DOCTEST_TEST_CASE("menus reach what the panels reach") {
    Harness harness({Wide, High, 1, Situation::Located, false});
    harness.click("menu.Select");
    DOCTEST_CHECK(harness.asks("menu.grow", "grow_label 1"));
    harness.click("menu.Prompt");
    DOCTEST_CHECK(harness.asks("menu.locate", "locate"));
    harness.click("menu.View");
    DOCTEST_CHECK(harness.asks("menu.wipe", "set_comparison 1"));
    harness.click("menu.Window");
    harness.click("menu.panel.Prompt");
    harness.frame(3);
    DOCTEST_CHECK(harness.find("tab.Prompt") == nullptr);
    harness.click("menu.Window");
    harness.click("menu.reset_layout");
    harness.frame(3);
    DOCTEST_CHECK(harness.find("tab.Prompt") != nullptr);
    DOCTEST_CHECK(harness.key_asks(key::F1, "open_guide"));
    harness.modifiers(true, false, false);
    harness.key(key::F1);
    harness.modifiers(false, false, false);
    harness.frame(3);
    DOCTEST_CHECK(harness.shell.state().help_open);
    harness.key(key::Escape);
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("tool.undo", "undo"));
}

DOCTEST_TEST_CASE("unsaved work is asked about before it goes") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.shell.request_quit();
    harness.frame(3);
    DOCTEST_CHECK(!harness.application.asked("quit"));
    harness.click("question.2");
    DOCTEST_CHECK(!harness.application.asked("quit"));
    harness.shell.request_quit();
    harness.frame(3);
    harness.application.calls.clear();
    harness.click("question.0");
    DOCTEST_REQUIRE(harness.application.calls.size() >= 2);
    DOCTEST_CHECK(harness.application.calls[0] == "save_project ");
    DOCTEST_CHECK(harness.application.calls[1] == "quit");
    harness.shell.request_open({"/tmp/x.ply"});
    harness.frame(3);
    harness.click("question.1");  // it takes the place of the open one
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("question.1", "open /tmp/x.ply"));
    harness.application.model().unsaved = false;
    harness.application.calls.clear();
    harness.shell.request_open({"/tmp/y.ply"});
    harness.frame(3);
    harness.click("question.1");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("open /tmp/y.ply"));
}

DOCTEST_TEST_CASE("a scene that is dropped on another one can be put into it, with its handles shown") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().unsaved = true;
    harness.shell.request_open({"/tmp/guitar.ply"});
    harness.frame(3);
    harness.click("question.0");
    harness.frame(3);
    DOCTEST_CHECK(harness.application.asked("put_in /tmp/guitar.ply"));
    DOCTEST_CHECK_FALSE(harness.application.asked("open"));
    DOCTEST_CHECK(harness.shell.state().viewport.tool == ui::Tool::Place);
    harness.shell.request_open({"/tmp/work.gsep"});  // a project is no thing
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("question.1", "open /tmp/work.gsep"));
}

DOCTEST_TEST_CASE("weights that are dropped are opened in the Models panel, whatever is unsaved") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().unsaved = true;
    for (const char* name : {"/tmp/style.safetensors", "/tmp/flux.gguf", "/tmp/old.ckpt", "/tmp/B.SFT"}) {
        harness.application.calls.clear();
        harness.shell.show(ui::PanelId::Prompt);
        harness.shell.request_open({name});
        harness.frame(4);
        DOCTEST_CHECK(harness.application.asked(std::string("open_model ") + name));
        DOCTEST_CHECK(harness.find("panel.Models") != nullptr);
        DOCTEST_CHECK_FALSE(harness.shell.state().question.pending);
    }
    harness.application.calls.clear();
    harness.shell.request_open({"/tmp/sparse/0/cameras.bin"});  // of COLMAP
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.application.asked("open_model"));
}

DOCTEST_TEST_CASE("of several files that are dropped, the artist says which is opened") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    harness.application.model().unsaved = false;
    harness.shell.request_open({"/tmp/x.ply", "/tmp/y.ply"});
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.application.asked("open /tmp/x.ply"));
    DOCTEST_CHECK(harness.asks("question.1", "open /tmp/y.ply"));
}

DOCTEST_TEST_CASE("keys of files and exports") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    DOCTEST_CHECK(harness.key_asks(key::F12, "export_picture"));
    harness.modifiers(true, false, false);
    DOCTEST_CHECK(harness.key_asks(key::F12, "export_turntable"));
    harness.modifiers(false, true, false);
    DOCTEST_CHECK(harness.key_asks('S', "save_project "));
    DOCTEST_CHECK(harness.key_asks('L', "locate"));
    DOCTEST_CHECK(harness.key_asks('=', "set_ui_scale 1.10"));
    harness.modifiers(false, false, false);
    DOCTEST_CHECK(harness.key_asks(key::F11, "toggle_fullscreen"));
    DOCTEST_CHECK(harness.key_asks('N', "set_view_settings"));
    DOCTEST_CHECK(!harness.application.model().view.front_only);
    DOCTEST_CHECK(harness.key_asks('T', "set_view_settings"));
    DOCTEST_CHECK(!harness.application.model().view.tint_labels);
    DOCTEST_CHECK(harness.key_asks(key::Right, "look_through 0"));
    DOCTEST_CHECK(harness.key_asks(key::Right, "look_through 1"));
    DOCTEST_CHECK(harness.key_asks(key::Left, "look_through 0"));
}

DOCTEST_TEST_CASE("toasts are closed and pressed") {
    Harness harness({Wide, High, 1, Situation::Scene, false});
    DOCTEST_CHECK(harness.asks("toast.0.button", "press_toast 0"));
    DOCTEST_CHECK(harness.asks("toast.0.close", "dismiss_toast 0"));
}

}  // namespace gse::test::actions_test
