// Image server in the artist's window: asked what it is, used after consent only, and forgotten.
#ifdef GSE_PYTHON
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/file.h"
#include "engine/io/image/image_file.h"
#include "engine/pipeline/models/remote_loader.h"
#include "engine/pipeline/report/picture_text.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/ui/app/session.h"

namespace server_session_test {

using namespace gse;
using namespace gse::test;

namespace {

bool can_ask() {
    if (pipeline::remote_library().empty()) skip_missing("libgse_remote.so is not there");
    return !pipeline::remote_library().empty() && remote::can_stand_in();
}

void choose(Session& session, const std::string& url) {
    gse::remote::ServerSettings settings;
    settings.url = url;
    session.app.run(command::SetServer{settings});
}

std::string all_facts(const ui::ServerView& server) {
    std::string text;
    for (const auto& fact : server.facts) text += fact.name + ": " + fact.value + " (" + fact.origin + ")\n";
    return text;
}

std::string question(const Session& session) { return session.app.model().question.text; }

double mean_difference(const Image& a, const Image& b) {
    DOCTEST_REQUIRE(a.data.size() == b.data.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::abs(a.data[i] - b.data[i]);
    return sum / static_cast<double>(a.data.size());
}

std::uint64_t questions(const Session& session) { return session.app.model().question.number; }

/// Everything in the folder, as one text.
std::string all_files(const fs::path& folder) {
    std::string text;
    for (const auto& file : fs::recursive_directory_iterator(folder))
        if (file.is_regular_file()) text += read_file(file.path());
    return text;
}

/// A sentence with a word that only a server draws, drawn small and quickly.
void ask_for_iridescence(Session& session) {
    auto request = session.app.model().request;
    request.source = "bear";
    request.prompt = "a golden iridescent bear";
    request.target = "golden iridescent";
    request.quality = "draft";
    request.method = "auto";
    request.views = 12;
    session.app.run(command::SetRequest{request});
}

/// The edit asked for with the server switched on; the question about it waits.
void ask_server(Session& session, const remote::StandIn& server) {
    session.open_bear();
    ask_for_iridescence(session);
    choose(session, server.url());
    session.app.run(command::UseServer{true});
    session.app.run(command::Edit{});
}

}  // namespace

DOCTEST_TEST_CASE("a server tells what it is; nothing is drawn, and its address outlives the program") {
    if (!can_ask()) return;
    const Place place;
    remote::StandIn server("sdserver");
    {
        Session session;
        choose(session, server.url());
        DOCTEST_CHECK(session.app.model().server.facts.empty());
        session.app.run(command::TestServer{});
        DOCTEST_CHECK(session.app.model().server.testing);
        DOCTEST_REQUIRE(session.idle());
        const auto facts = all_facts(session.app.model().server);
        DOCTEST_CHECK(facts.find("sd-server") != std::string::npos);
        DOCTEST_CHECK(facts.find("Family: sd15") != std::string::npos);
        DOCTEST_CHECK(facts.find("a guess") != std::string::npos);
        DOCTEST_CHECK(session.app.model().server.problem == "");
        session.app.run(command::UseServer{true});
        DOCTEST_CHECK(session.app.model().server.on);
        session.app.shut_down();
    }
    DOCTEST_CHECK(server.asked("/img_gen").empty());
    Session again;
    DOCTEST_CHECK(again.app.model().server.choice.url == server.url());
    DOCTEST_CHECK_FALSE(again.app.model().server.on);
    again.app.run(command::ForgetServer{});
    DOCTEST_CHECK(again.app.model().server.choice.url.empty());
}

DOCTEST_TEST_CASE("settings of the drawing are checked, keep their origin, and outlive the program") {
    if (!can_ask()) return;
    const Place place;
    remote::StandIn server("sdserver");
    {
        Session session;
        choose(session, server.url());
        session.app.run(command::TestServer{});
        DOCTEST_REQUIRE(session.idle());
        const auto& view = session.app.model().server;
        DOCTEST_CHECK(view.usual.side > 0);
        DOCTEST_CHECK(view.loras == std::vector<std::string>{"bronze"});
        DOCTEST_CHECK(all_facts(view).find("of the family") != std::string::npos);
        auto choice = view.choice;
        choice.steps = 9;
        const auto before = server.log().size();
        session.app.run(command::SetServer{choice});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(server.log().size() == before);  // a number needs no answer
        DOCTEST_CHECK(all_facts(view).find("9 steps") != std::string::npos);
        DOCTEST_CHECK(all_facts(view).find("some chosen by you") != std::string::npos);
        choice.lora = {"bronze:0.5"};
        session.app.run(command::SetServer{choice});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(view.problem == "");
        choice.option = {"no option"};
        session.app.run(command::SetServer{choice});
        DOCTEST_CHECK(view.choice.option.empty());
        choice.option.clear();
        choice.lora = {"silver"};  // the server has none of that name
        session.app.run(command::SetServer{choice});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(view.problem.find("silver") != std::string::npos);
        DOCTEST_CHECK(view.loras == std::vector<std::string>{"bronze"});  // to choose another
        choice.lora = {"bronze:0.5"};
        session.app.run(command::SetServer{choice});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(view.problem == "");
        session.app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().server.choice.steps == 9);
    DOCTEST_CHECK(again.app.model().server.choice.lora == std::vector<std::string>{"bronze:0.5"});
    again.app.shut_down();
}

DOCTEST_TEST_CASE("a server that nobody runs is a sentence with a remedy, and no question to the artist") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    choose(session, "http://127.0.0.1:1");
    session.app.run(command::TestServer{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(session.app.model().server.facts.empty());
    DOCTEST_CHECK(session.app.model().server.problem.find("127.0.0.1:1") != std::string::npos);
    DOCTEST_CHECK(question(session).empty());
}

DOCTEST_TEST_CASE("a password goes into the file of passwords alone") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    choose(session, "http://mira:verysecret@127.0.0.1:9");
    DOCTEST_CHECK(session.app.model().server.choice.url == "http://127.0.0.1:9");
    const auto file = place.folder / "config/servers.json";
    DOCTEST_REQUIRE(fs::exists(file));
    DOCTEST_CHECK((fs::status(file).permissions() & fs::perms::others_all) == fs::perms::none);
    session.app.run(command::KeepServerPassword{"mira", "other:se/cret"});
    DOCTEST_CHECK(read_file(file).find("other:se/cret") != std::string::npos);
    session.app.run(command::ForgetServer{});
    session.app.shut_down();
    DOCTEST_CHECK(all_files(place.folder).find("cret") == std::string::npos);
}

DOCTEST_TEST_CASE("nothing goes to a server before the artist has agreed, and a No sends nothing") {
    if (!can_ask() || !networks()) return;
    const Place place;
    remote::StandIn server("sdserver");
    Session session;
    ask_server(session, server);
    DOCTEST_CHECK_FALSE(session.app.model().job.running);
    DOCTEST_CHECK(question(session).starts_with("4 pictures"));
    DOCTEST_CHECK(question(session).find("a golden iridescent bear") != std::string::npos);
    DOCTEST_CHECK(question(session).find("not encrypted") == std::string::npos);
    DOCTEST_CHECK(question(session).find("this machine") != std::string::npos);
    session.app.run(command::Answer{1});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(server.log().empty());
    choose(session, "http://203.0.113.9:7860");  // a public address
    DOCTEST_CHECK_FALSE(session.app.model().server.on);
    session.app.run(command::UseServer{true});
    session.app.run(command::Edit{});
    DOCTEST_CHECK(question(session).find("not encrypted") != std::string::npos);
    DOCTEST_CHECK(question(session).find("public address") != std::string::npos);
}

DOCTEST_TEST_CASE("an edit by a server is counted in pictures; their time is not known before one came") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    session.open_bear();
    ask_for_iridescence(session);
    const auto& estimate = session.app.model().estimate;
    choose(session, "http://127.0.0.1:1");
    DOCTEST_CHECK(estimate.server_pictures == 0);
    session.app.run(command::UseServer{true});
    DOCTEST_REQUIRE(session.until([&] { return estimate.server_pictures == 4; }));
    DOCTEST_CHECK(estimate.server_seconds < 0);
    session.app.run(command::UseServer{false});
    DOCTEST_REQUIRE(session.until([&] { return estimate.server_pictures == 0; }));
}

DOCTEST_TEST_CASE(
    "after the consent the server draws the edit, is not asked about again, and can be stopped") {
    if (!can_ask() || !networks()) return;
    const Place place;
    remote::StandIn server("sdserver");
    Session session;
    ask_server(session, server);
    session.app.run(command::Answer{0});
    bool told = false;
    DOCTEST_REQUIRE(session.until([&] {
        told |= session.app.model().job.stage.find("view 3 of 4") != std::string::npos;
        return !session.app.model().job.running;
    }));
    DOCTEST_CHECK(told);
    DOCTEST_CHECK(session.app.model().job.error == "");
    DOCTEST_REQUIRE(session.app.model().result_waiting);
    DOCTEST_CHECK(server.asked("/img_gen").size() == 4);
    const auto& estimate = session.app.model().estimate;
    DOCTEST_CHECK(estimate.server_seconds > 0);  // of what was measured, in the frame that shows the result
    DOCTEST_CHECK(estimate.server_pictures == 4);
    DOCTEST_CHECK(estimate.seconds < 0);  // the model here draws nothing
    session.app.run(command::DiscardResult{});
    server.set({{"draw_s", "5"}});
    auto request = session.app.model().request;
    request.seed += 1;
    session.app.run(command::SetRequest{request});
    const auto asked = questions(session);
    session.app.run(command::Edit{});
    DOCTEST_CHECK(questions(session) == asked);
    DOCTEST_REQUIRE(session.until(
        [&] { return session.app.model().job.stage.find("at the server") != std::string::npos; }));
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(session.app.model().job.outcome == "stopped");
    DOCTEST_CHECK_FALSE(session.app.model().result_waiting);
}

DOCTEST_TEST_CASE(
    "a picture of the artist's own is taken for its view, which the server does not draw then") {
    if (!can_ask() || !networks()) return;
    const Place place;
    remote::StandIn server("sdserver");
    Session session;
    ask_server(session, server);
    session.app.run(command::Answer{0});
    DOCTEST_REQUIRE(session.idle());
    const auto& model = session.app.model();
    DOCTEST_REQUIRE(model.target_rounds.size() == 1);
    const auto target = model.target_rounds.back().targets.at(1);
    session.app.run(command::DiscardResult{});
    auto choice = model.server.choice;
    choice.target_picture = {target.name + "=" + (place.folder / "own.png").string()};
    session.app.run(command::SetServer{choice});  // there is no such file
    DOCTEST_CHECK(model.server.choice.target_picture.empty());
    write_png(place.folder / "own.png", *target.after);
    session.app.run(command::SetServer{choice});
    DOCTEST_CHECK(model.toasts.back().text.find("own.png") != std::string::npos);
    auto request = model.request;
    request.seed += 1;
    session.app.run(command::SetRequest{request});
    const auto before = server.asked("/img_gen").size();
    session.app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.job.error == "");
    // The other three are carried over by depth: filled, then drawn once more.
    DOCTEST_CHECK(server.asked("/img_gen").size() == before + 6);
    const auto& followed = model.target_rounds.back().targets.at(1);
    DOCTEST_CHECK(followed.name == target.name);
    DOCTEST_CHECK(mean_difference(*followed.after, *target.after) < 0.02);
    DOCTEST_REQUIRE(session.until([&] { return model.estimate.server_pictures == 6; }));
    DOCTEST_CHECK(model.estimate.server_seconds > 0);
    session.app.run(command::DiscardResult{});
    choice.target_picture.clear();
    session.app.run(command::SetServer{choice});
    DOCTEST_CHECK(model.server.choice.target_picture.empty());
    session.app.shut_down();
}

DOCTEST_TEST_CASE("a recipe that names a server is told of, and changes neither address nor switch") {
    const Place place;
    const auto picture = place.folder / "before_after.png";
    pipeline::EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a golden bear";
    recipe.server.url = "http://mira:verysecret@203.0.113.9:7860";
    write_png(picture, Image(8, 8, 3), pipeline::picture_text(recipe, pipeline::recipe_to_json(recipe)));
    DOCTEST_CHECK(read_file(picture).find("verysecret") == std::string::npos);
    Session session;
    session.app.run(command::Open{picture});
    DOCTEST_REQUIRE(session.until([&] { return session.app.model().request.prompt == "a golden bear"; }, 60));
    DOCTEST_CHECK_FALSE(session.app.model().server.on);
    DOCTEST_CHECK(session.app.model().server.choice.url.empty());
    std::string said;
    for (const auto& toast : session.app.model().toasts) said += toast.text;
    DOCTEST_CHECK(said.find("203.0.113.9:7860") != std::string::npos);
}

}  // namespace server_session_test
#endif
