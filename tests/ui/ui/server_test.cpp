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
