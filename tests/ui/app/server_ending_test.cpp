// Drawings of an image server that end early or last long, and servers on this machine.
#ifdef GSE_PYTHON
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "tests/ui/app/server_session.h"

namespace server_ending_test {

using namespace gse;
using namespace gse::test;
using namespace server_sessions;

namespace {

/// An edit of eight views whose server ends after five of them, or is stopped then.
struct Ended {
    Asked asked;
    Session& session = asked.session;
    const ui::ViewModel& model = asked.model;

    explicit Ended(const remote::Knobs& knobs) : asked("sdserver", knobs) {
        session.app.run(command::Answer{1});
        auto request = model.request;
        request.edited_views = 16;  // half of them in draft quality
        session.app.run(command::SetRequest{request});
        session.app.run(command::Edit{});
        asked.agree();
    }
    bool is_asked() {
        return session.until([&] { return question(session).find("views are drawn") != std::string::npos; });
    }
    std::size_t missing() const {
        const auto& targets = model.target_rounds.back().targets;
        return static_cast<std::size_t>(
            std::count_if(targets.begin(), targets.end(), [](const auto& one) { return one.missing; }));
    }
};

}  // namespace

DOCTEST_TEST_CASE("a server that fails late leaves a question: the views that came, or none of them") {
    if (!can_draw()) return;
    for (const bool fits : {true, false}) {
        DOCTEST_CAPTURE(fits);
        Ended edit({{"fault", "html_500"}, {"at", "draw"}, {"after", "5"}});
        DOCTEST_REQUIRE(edit.is_asked());
        DOCTEST_CHECK(edit.model.job.running);
        DOCTEST_CHECK(edit.model.question.answers.at(0).text == "Fit with 5 of 8 views");
        DOCTEST_CHECK(question(edit.session).find("; missing: ") != std::string::npos);
        edit.session.app.run(command::Answer{fits ? 0u : 1u});
        DOCTEST_REQUIRE(edit.session.idle());
        DOCTEST_CHECK(edit.model.result_waiting == fits);
        DOCTEST_CHECK(edit.model.job.error.empty() == fits);
        if (!fits) continue;
        DOCTEST_CHECK(edit.missing() == 3);
        const auto& warnings = edit.model.target_rounds.back().warnings;
        DOCTEST_CHECK(std::any_of(warnings.begin(), warnings.end(), [](const auto& warning) {
            return warning.starts_with("3 of 8 views were not drawn");
        }));
    }
}

DOCTEST_TEST_CASE("Cancel of a drawing with enough views asks first, and ends the edit on a Stop") {
    if (!can_draw()) return;
    for (const bool fits : {true, false}) {
        DOCTEST_CAPTURE(fits);
        Ended edit(remote::Knobs{{"draw_s", "0.6"}});
        DOCTEST_REQUIRE(edit.session.until([&] {
            return edit.model.job.stage.find("view 6 of 8") != std::string::npos &&
                   edit.asked.server.asked("/img_gen").size() == 6;
        }));
        edit.session.app.run(command::Cancel{});
        DOCTEST_REQUIRE(edit.is_asked());
        DOCTEST_REQUIRE(edit.session.until([&] { return !edit.asked.server.asked("/cancel").empty(); }));
        edit.session.app.run(command::Answer{fits ? 0u : 1u});
        DOCTEST_REQUIRE(edit.session.idle());
        DOCTEST_CHECK(edit.model.result_waiting == fits);
        DOCTEST_CHECK(edit.model.job.error.empty());
        if (fits) DOCTEST_CHECK(edit.missing() == 3);
        else DOCTEST_CHECK(edit.model.job.outcome == "stopped");
    }
}

DOCTEST_TEST_CASE("a view that takes much longer than those before it is told, in Progress and in the log") {
    if (!can_draw()) return;
    Ended edit(remote::Knobs{{"draw_s", "0.2"}});
    DOCTEST_REQUIRE(
        edit.session.until([&] { return edit.model.job.stage.find("view 4 of 8") != std::string::npos; }));
    edit.asked.server.set({{"draw_s", "600"}});
    DOCTEST_REQUIRE(edit.session.until([&] {
        return edit.model.job.stage.find("it takes longer than the views before") != std::string::npos;
    }));
    DOCTEST_CHECK(edit.model.job.stage.find(" of 8 at 127.0.0.1:") != std::string::npos);
    const auto& log = edit.model.log;
    DOCTEST_REQUIRE(edit.session.until([&] {
        return std::any_of(log.begin(), log.end(), [](const auto& line) {
            return line.text.find("it is waited for") != std::string::npos;
        });
    }));
    edit.session.app.run(command::Cancel{});
    edit.session.app.run(command::Cancel{});  // also where the first one only ended the drawing
    DOCTEST_REQUIRE(edit.session.idle());
}

DOCTEST_TEST_CASE("servers on this machine are looked for on a click, and one of them is taken") {
    if (!can_ask()) return;
    const Place place;
    const auto server = remote::stand_in_at_usual_port("comfy");
    if (!server) return;
    Session session;
    const auto& view = session.app.model().server;
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(server->log().empty());  // not at the start
    session.app.run(command::FindServers{});
    DOCTEST_CHECK(view.looking);
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK_FALSE(view.looking);
    DOCTEST_CHECK(view.looked);
    const auto found = std::find_if(view.here.begin(), view.here.end(),
                                    [&](const auto& one) { return one.url == server->url(); });
    DOCTEST_REQUIRE(found != view.here.end());
    DOCTEST_CHECK(found->usable);
    DOCTEST_CHECK(found->text.starts_with("ComfyUI at 127.0.0.1:"));
    for (const auto& entry : server->log()) DOCTEST_CHECK(entry["method"] == "GET");
    choose(session, found->url);
    DOCTEST_CHECK_FALSE(view.on);
    DOCTEST_CHECK_FALSE(view.here.empty());  // still to be seen
    session.app.shut_down();
}

DOCTEST_TEST_CASE("the address stands in the progress while a server is tested or searches") {
    if (!can_draw()) return;
    const Place place;
    remote::StandIn server("sdserver");
    server.set({{"model", "flux1-kontext-dev"}, {"edits", "red"}});
    Session session;
    const auto& model = session.app.model();
    session.open_bear();
    choose_small(session, server.url());
    const auto address = server.url().substr(std::string("http://").size());
    bool told = false;
    const auto ended = [&] {
        told |= model.job.stage.find(address) != std::string::npos;
        return !model.job.running;
    };
    server.set({{"fault", "hang"}, {"at", "probe"}, {"times", "1"}});
    session.app.run(command::TestServer{});
    DOCTEST_REQUIRE(session.until([&] { return ended() || told; }));
    DOCTEST_CHECK(told);
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    server.set({{"fault", ""}});
    auto request = model.request;
    request.source = "gizmo", request.prompt = "a golden gizmo", request.target = "golden";
    request.quality = "draft", request.method = "auto", request.views = 12;
    session.app.run(command::SetRequest{request});
    session.app.run(command::UseServer{true});
    DOCTEST_REQUIRE(session.until([&] { return !model.server_search.empty(); }));
    session.app.run(command::Locate{false, true});
    told = false;
    DOCTEST_REQUIRE(
        session.until([&] { return ended() || model.job.stage == "looking for \"gizmo\" at " + address; }));
    DOCTEST_CHECK(told);
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    session.app.shut_down();
}

}  // namespace server_ending_test
#endif
