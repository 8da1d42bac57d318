// Image server in the Models panel, by clicks: its address, the test, its facts, the switch, a password.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/ui/support/harness.h"
#include "ui/state/state.h"

namespace gse::test::server_test {
namespace {

/// Models alone in a window high enough for all of it, with a server where `url` is not empty.
struct Panel : Harness {
    explicit Panel(const std::string& url = {}) : Harness({1600, 3200, 1, Situation::Scene, false}) {
        application.model().server.choice.url = url;
        shell.show(ui::PanelId::Models);
        frame(3);
    }
    void write(const std::string& field, const std::string& text) {
        click(field);
        type(text);
        frame(2);
    }
    bool asked(const std::string& call) const { return application.asked(call); }
};

}  // namespace

DOCTEST_TEST_CASE("servers on this machine are looked for on a click alone, and one of them is taken") {
    Panel panel;
    DOCTEST_CHECK_FALSE(panel.asked("find_servers"));
    DOCTEST_CHECK(panel.find("models.server.here.0") == nullptr);
    DOCTEST_CHECK(panel.asks("models.server.find", "find_servers"));
    auto& server = panel.application.model().server;
    server.looked = true;
    server.here = {{"http://127.0.0.1:8000", "127.0.0.1:8000 speaks no protocol of image servers", false},
                   {"http://127.0.0.1:8188", "ComfyUI at 127.0.0.1:8188", true}};
    panel.frame(2);
    DOCTEST_CHECK(panel.find("models.server.here.0") == nullptr);  // it cannot be used
    DOCTEST_CHECK(panel.asks("models.server.here.1", "set_server http://127.0.0.1:8188"));
    DOCTEST_CHECK(panel.shell.state().models.server_url == "http://127.0.0.1:8188");
}

DOCTEST_TEST_CASE("an address is judged as it is typed; without one there is nothing to test or to use") {
    Panel panel;
    DOCTEST_CHECK_FALSE(panel.rect("models.server.test").enabled);
    DOCTEST_CHECK_FALSE(panel.asks("models.server.on", "use_server"));
    panel.write("models.server.url", "ftp://somewhere");
    DOCTEST_CHECK(panel.shell.state().models.server_problem.find("http or https") != std::string::npos);
    DOCTEST_CHECK_FALSE(panel.asks("models.server.test", "test_server"));
    Panel other;
    other.write("models.server.url", "192.168.1.20:7860");
    DOCTEST_CHECK(other.shell.state().models.server_problem.empty());
    DOCTEST_CHECK(other.asks("models.server.test", "test_server"));
    DOCTEST_CHECK(other.asked("set_server 192.168.1.20:7860"));
    DOCTEST_CHECK_FALSE(other.asked("use_server"));
}

DOCTEST_TEST_CASE("a password in the address leaves the screen with the first use") {
    Panel panel("http://10.0.0.5:7860");
    panel.shell.state().models.server_url.clear();
    panel.write("models.server.url", "http://mira:secret@10.0.0.5:7860");
    DOCTEST_CHECK(panel.asks("models.server.test", "set_server http://mira:secret@10.0.0.5:7860"));
    panel.frame(3);
    DOCTEST_CHECK(panel.shell.state().models.server_url == "http://10.0.0.5:7860");
}

DOCTEST_TEST_CASE("the switch is off until it is pressed, and tells its state") {
    Panel panel("http://127.0.0.1:1234");
    DOCTEST_CHECK_FALSE(panel.application.model().server.on);
    DOCTEST_CHECK(panel.asks("models.server.on", "use_server on"));
    panel.application.model().server.on = true;
    panel.frame(2);
    DOCTEST_CHECK(panel.asks("models.server.on", "use_server off"));
}

DOCTEST_TEST_CASE("facts take room as they come, and models, family and agreement can be chosen") {
    Panel panel("http://127.0.0.1:1234");
    const float before = panel.rect("models.server.agreement").y;
    DOCTEST_CHECK(panel.find("models.server.model") == nullptr);
    auto& server = panel.application.model().server;
    server.facts = {{"Server", "sd-server 1.2 (sdcpp)"}, {"Family", "sd15", "from the model's name"}};
    server.models = {"first", "second"};
    server.families = {"auto", "sd15", "kontext"};
    panel.frame(3);
    DOCTEST_CHECK(panel.rect("models.server.agreement").y > before);
    panel.click("models.server.agreement");
    panel.frame(2);
    DOCTEST_CHECK(panel.asks("models.server.agreement.warp", "set_server http://127.0.0.1:1234  auto warp"));
    panel.click("models.server.family");
    panel.frame(2);
    DOCTEST_CHECK(
        panel.asks("models.server.family.kontext", "set_server http://127.0.0.1:1234  kontext auto"));
    panel.click("models.server.model");
    panel.frame(2);
    DOCTEST_CHECK(panel.asks("models.server.model.second", "set_server http://127.0.0.1:1234 second auto"));
}

namespace {

/// Drawing settings, unfolded, of a server that was asked and has two LoRAs.
struct Drawing : Panel {
    Drawing() : Panel("http://127.0.0.1:1234") {
        auto& server = application.model().server;
        server.facts = {{"Server", "sd-server 1.2 (sdcpp)"}};
        server.usual.side = 512, server.usual.steps = 20;
        server.usual.guidance = 7, server.usual.strength = 0.75;
        server.loras = {"bronze", "clay"};
        frame(3);
        click("models.server.drawing");
        frame(3);
    }
    ui::ServerView& server() { return application.model().server; }
};

}  // namespace

DOCTEST_TEST_CASE("drawing settings are shown for a server that was asked; its numbers are the family's") {
    Panel untested("http://127.0.0.1:1234");
    DOCTEST_CHECK(untested.find("models.server.drawing") == nullptr);
    Drawing panel;
    for (const char* name : {"side", "steps", "guidance", "strength"})
        DOCTEST_CHECK(panel.find(std::string("models.server.") + name + ".origin") != nullptr);
    DOCTEST_CHECK_FALSE(panel.asked("set_server"));
    const auto steps = panel.middle("models.server.steps");
    panel.drag(steps, {steps.x + 60, steps.y});
    DOCTEST_CHECK(panel.asked("set_server http://127.0.0.1:1234  auto auto 0 "));
    DOCTEST_CHECK_FALSE(panel.asked("set_server http://127.0.0.1:1234  auto auto 0 0"));
}

DOCTEST_TEST_CASE("a number that was chosen goes back to the family's by a right click") {
    Drawing panel;
    panel.server().choice.steps = 33;
    panel.frame(2);
    panel.click("models.server.steps", 1);
    panel.frame(2);
    DOCTEST_CHECK(panel.asked("set_server http://127.0.0.1:1234  auto auto 0 0 0 0 []"));
}

DOCTEST_TEST_CASE("LoRAs of the server are picked from its list, weighed and taken off") {
    Drawing panel;
    panel.click("models.server.lora");
    panel.frame(2);
    DOCTEST_CHECK(panel.asks("models.server.lora.clay",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [clay:1]"));
    panel.server().choice.lora = {"clay:1"};
    panel.frame(3);
    DOCTEST_CHECK(panel.rect("models.server.loras").y < panel.rect("models.server.lora.0.weight").y);
    panel.click("models.server.lora");
    panel.frame(2);
    DOCTEST_CHECK(panel.find("models.server.lora.clay") == nullptr);  // it is used already
    Drawing other;
    other.server().choice.lora = {"clay:1"};
    other.frame(3);
    DOCTEST_CHECK(other.asks("models.server.lora.0.remove",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] []"));
}

DOCTEST_TEST_CASE("a LoRA is typed where the server has no list, and there is no field where it takes none") {
    Drawing panel;
    panel.server().loras.clear();
    panel.server().lora_names = remote::LoraNames::Any;
    panel.frame(3);
    DOCTEST_CHECK_FALSE(panel.rect("models.server.lora.add").enabled);
    panel.write("models.server.lora", "looks/brass:0.5");
    DOCTEST_CHECK(panel.asks("models.server.lora.add",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [looks/brass:0.5]"));
    DOCTEST_CHECK(panel.shell.state().models.server_lora.empty());
    panel.server().choice.lora = {"looks/brass:0.5"};
    panel.frame(3);
    DOCTEST_CHECK(panel.rect("models.server.lora.0.weight").y < panel.rect("models.server.lora").y);
    panel.write("models.server.lora", "looks/brass");
    DOCTEST_CHECK_FALSE(panel.rect("models.server.lora.add").enabled);  // it is used already
    panel.server().choice.lora.clear();
    panel.server().lora_names = remote::LoraNames::None;
    panel.frame(3);
    DOCTEST_CHECK(panel.find("models.server.lora") == nullptr);
    panel.server().lora_names = remote::LoraNames::Listed;
    panel.frame(3);
    DOCTEST_CHECK(panel.find("models.server.lora") == nullptr);  // it has none
}

DOCTEST_TEST_CASE("a picture in the making stands beside what was sent, and leaves no gap when it has come") {
    Harness harness({1600, 1000, 1, Situation::Editing});
    harness.shell.show(ui::PanelId::Progress);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("progress.preview") == nullptr);
    const float before = harness.rect("progress.snapshot").y;
    auto& drawing = harness.application.model().drawing;
    drawing.sent = std::make_shared<const Image>(64, 64, 3, 0.4f);
    drawing.preview = std::make_shared<const Image>(8, 8, 3, 0.8f);
    harness.frame(3);
    DOCTEST_REQUIRE(harness.find("progress.preview") != nullptr);
    DOCTEST_CHECK(harness.rect("progress.sent").x < harness.rect("progress.preview").x);
    DOCTEST_CHECK(harness.rect("progress.sent").y == harness.rect("progress.preview").y);
    DOCTEST_CHECK(harness.rect("progress.snapshot").y > before);
    drawing = {};
    harness.frame(3);
    DOCTEST_CHECK(harness.find("progress.preview") == nullptr);
    DOCTEST_CHECK(harness.rect("progress.snapshot").y == before);
}

DOCTEST_TEST_CASE("a source without a word is looked for by the server where that is offered") {
    Harness harness({1600, 1400, 1, Situation::Scene, false});
    harness.shell.show(ui::PanelId::Prompt);
    auto& model = harness.application.model();
    model.known_words = {"bear", "golden", "hat", "red"};
    model.words_known = true;
    model.request.source = "gizmo", model.request.prompt = "a golden gizmo", model.request.target = "golden";
    harness.frame(3);
    DOCTEST_CHECK(harness.find("prompt.source.by_hand") != nullptr);
    DOCTEST_CHECK(harness.find("prompt.source.by_server") == nullptr);
    model.server_search = "16 pictures of your scene go to 127.0.0.1:1234.";
    harness.frame(3);
    DOCTEST_CHECK(harness.asks("prompt.source.by_server", "locate by server"));
    DOCTEST_CHECK(harness.shell.state().prompt.locate_problem.find("let the server find it") !=
                  std::string::npos);
    const float first = harness.rect("prompt.source.by_server").width;
    model.labelled_by_hand = true;  // by what it found, which may be wrong
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("prompt.source.by_server").width > first);  // "... again"
    DOCTEST_CHECK(harness.asks("prompt.source.by_server", "locate by server"));
    model.job.running = true;
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.rect("prompt.source.by_server").enabled);
}

DOCTEST_TEST_CASE("options of the server are added one by one, and what is none is not") {
    Drawing panel;
    panel.write("models.server.option", "karras");
    DOCTEST_CHECK_FALSE(panel.rect("models.server.option.add").enabled);
    panel.shell.state().models.server_option.clear();
    panel.frame(2);
    Drawing other;
    other.write("models.server.option", "scheduler=karras");
    DOCTEST_CHECK(other.asks("models.server.option.add",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [scheduler=karras]"));
    DOCTEST_CHECK(other.shell.state().models.server_option.empty());
    other.server().choice.option = {"scheduler=karras"};
    other.frame(3);
    DOCTEST_CHECK(other.asks("models.server.option.0.remove",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [] []"));
}

DOCTEST_TEST_CASE("certificates are a file for every server, a workflow is one for ComfyUI") {
    Drawing panel;
    DOCTEST_CHECK(panel.find("models.server.workflow") == nullptr);
    panel.server().is_comfy = true;
    panel.frame(3);
    panel.write("models.server.workflow", "/tmp/flow.json");
    DOCTEST_CHECK(panel.asks("models.server.workflow.use",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [] [] /tmp/flow.json"));
    DOCTEST_CHECK(panel.asks("models.server.paid_nodes",
                             "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [] []   paid"));
    panel.click("models.server.ca.browse");
    panel.frame(2);
    DOCTEST_CHECK(panel.shell.state().files.is_open());
}

DOCTEST_TEST_CASE("a kept password is not shown again, and a server can be forgotten") {
    Panel panel("http://127.0.0.1:1234");
    panel.click("models.server.secret");
    panel.frame(3);
    DOCTEST_CHECK_FALSE(panel.rect("models.server.keep").enabled);
    panel.write("models.server.user", "mira");
    panel.write("models.server.password", "secret");
    DOCTEST_CHECK(panel.asks("models.server.keep", "keep_server_password mira 6"));
    DOCTEST_CHECK(panel.shell.state().models.server_password.empty());
    DOCTEST_CHECK(panel.asks("models.server.forget", "forget_server"));
    DOCTEST_CHECK(panel.shell.state().models.server_url.empty());
}

DOCTEST_TEST_CASE("the estimate is the server's where it draws, also before it has drawn anything") {
    Harness harness({1600, 1000, 1, Situation::Scene, false});
    auto& estimate = harness.application.model().estimate;
    estimate = {};
    harness.frame(3);
    DOCTEST_CHECK(harness.find("prompt.estimate") == nullptr);
    estimate.server_pictures = 8;
    harness.frame(3);
    const auto unknown = harness.rect("prompt.estimate");
    DOCTEST_CHECK(unknown.visible);
    estimate.server_seconds = 42;
    harness.frame(3);
    DOCTEST_CHECK(harness.rect("prompt.estimate").visible);
    DOCTEST_CHECK(harness.rect("prompt.estimate").width < unknown.width);  // "about 42 s for 8 pictures"
}

DOCTEST_TEST_CASE(
    "a view of the edit takes a picture of the artist's own, dropped or chosen, and gives it back") {
    Harness harness({1920, 1080, 1, Situation::ResultWaiting, false});
    harness.shell.show(ui::PanelId::Targets);
    harness.frame(3);
    DOCTEST_CHECK(harness.find("targets.1.own") == nullptr);  // the model here draws
    auto& model = harness.application.model();
    const auto view = model.target_rounds.back().targets[1].name;
    model.server.on = true;
    model.server.choice.url = "http://127.0.0.1:1234";
    harness.frame(3);
    harness.click("targets.1.own");
    harness.frame(2);
    DOCTEST_CHECK(harness.shell.state().files.is_open());
    Harness other({1920, 1080, 1, Situation::ResultWaiting, false});
    auto& shown = other.application.model();
    shown.server = model.server;
    other.shell.show(ui::PanelId::Targets);
    other.frame(3);
    other.shell.request_open({"/tmp/painted.png"});
    other.frame(3);
    DOCTEST_CHECK(other.application.asked("open /tmp/painted.png"));  // no view is selected
    other.click("targets.1");
    other.frame(2);
    DOCTEST_CHECK(other.shell.state().targets.view == view);
    other.shell.request_open({"/tmp/painted.png"});
    other.frame(3);
    DOCTEST_CHECK(other.application.asked("set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [] [" +
                                          view + "=/tmp/painted.png]"));
    shown.server.choice.target_picture = {view + "=/tmp/painted.png"};
    other.frame(3);
    DOCTEST_CHECK(
        other.asks("targets.own.0.clear", "set_server http://127.0.0.1:1234  auto auto 0 0 0 0 [] [] []"));
}

DOCTEST_TEST_CASE("with a server, words that the model cannot draw are no obstacle to an edit") {
    Harness harness({1600, 1000, 1, Situation::Scene, false});
    auto& model = harness.application.model();
    model.request.prompt = "a porcelain bear";
    model.request.target = "porcelain";
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.shell.state().prompt.problem.empty());
    model.server.on = true;
    harness.frame(3);
    DOCTEST_CHECK(harness.shell.state().prompt.problem == "");
    model.request.source = "zeppelin";  // it still has to be found
    harness.frame(3);
    DOCTEST_CHECK_FALSE(harness.shell.state().prompt.problem.empty());
}

}  // namespace gse::test::server_test
