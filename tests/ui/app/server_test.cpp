// Image server in the artist's window: asked what it is, used after consent only, and forgotten.
#ifdef GSE_PYTHON
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/file.h"
#include "engine/io/image/image_file.h"
#include "engine/pipeline/models/remote_loader.h"
#include "engine/pipeline/report/picture_text.h"
#include "tests/ui/app/server_session.h"

namespace server_session_test {

using namespace gse;
using namespace gse::test;

using namespace server_sessions;

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

DOCTEST_TEST_CASE("a model that the server lacks leaves the list to choose another from") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    remote::StandIn server("forge");
    const auto& view = session.app.model().server;
    choose(session, server.url());
    session.app.run(command::TestServer{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(view.models.size() == 2);
    auto choice = view.choice;
    choice.model = "nonsense";
    session.app.run(command::SetServer{choice});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(view.problem.find("nonsense") != std::string::npos);
    DOCTEST_CHECK(view.models.size() == 2);
    session.app.shut_down();
}

DOCTEST_TEST_CASE("a server without a list of LoRAs says so, and one that is typed is kept for it") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    const auto& view = session.app.model().server;
    for (const auto& [flavour, names] : {std::pair{"vllm", gse::remote::LoraNames::Any},
                                         std::pair{"openai", gse::remote::LoraNames::None}}) {
        DOCTEST_CAPTURE(flavour);
        remote::StandIn server(flavour);
        choose(session, server.url());
        session.app.run(command::TestServer{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(view.loras.empty());
        DOCTEST_CHECK(view.lora_names == names);
        auto choice = view.choice;
        choice.lora = {"looks/brass:0.5"};
        session.app.run(command::SetServer{choice});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(view.problem.empty() == (names == gse::remote::LoraNames::Any));
        DOCTEST_CHECK(view.lora_names == names);
        DOCTEST_CHECK(view.choice.lora == choice.lora);
    }
    session.app.shut_down();
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
    if (!can_draw()) return;
    Asked asked;
    auto& session = asked.session;
    auto& server = asked.server;
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
    if (!can_draw()) return;
    Asked asked;
    auto& session = asked.session;
    auto& server = asked.server;
    asked.agree();
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
    const auto before = questions(session);
    asked.edit_again();
    DOCTEST_CHECK(questions(session) == before);
    DOCTEST_REQUIRE(session.until(
        [&] { return session.app.model().job.stage.find(" at 127.0.0.1:") != std::string::npos; }));
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(session.app.model().job.outcome == "stopped");
    DOCTEST_CHECK_FALSE(session.app.model().result_waiting);
}

DOCTEST_TEST_CASE(
    "a picture of the artist's own is taken for its view, which the server does not draw then") {
    if (!can_draw()) return;
    Asked asked;
    auto& session = asked.session;
    auto& server = asked.server;
    const auto& model = asked.model;
    asked.agree();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(model.target_rounds.size() == 1);
    const auto target = model.target_rounds.back().targets.at(1);
    session.app.run(command::DiscardResult{});
    auto choice = model.server.choice;
    choice.target_picture = {target.name + "=" + (asked.place.folder / "own.png").string()};
    session.app.run(command::SetServer{choice});  // there is no such file
    DOCTEST_CHECK(model.server.choice.target_picture.empty());
    Image own = *target.after;
    for (int y = 0; y < own.height / 4; ++y)
        for (int x = 0; x < own.width / 4; ++x) own.at(x, y, 0) = own.at(x, y, 2) = 1, own.at(x, y, 1) = 0;
    write_png(asked.place.folder / "own.png", own);
    session.app.run(command::SetServer{choice});
    DOCTEST_CHECK(model.toasts.back().text.find("own.png") != std::string::npos);
    const auto before = server.asked("/img_gen").size();
    asked.edit_again();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.job.error == "");
    // The other three are carried over by depth: filled, then drawn once more.
    DOCTEST_CHECK(server.asked("/img_gen").size() == before + 6);
    const auto& followed = model.target_rounds.back().targets.at(1);
    DOCTEST_CHECK(followed.name == target.name);
    DOCTEST_CHECK(mean_difference(*followed.after, *target.after) < 0.02);  // without the corner
    const auto& warnings = model.target_rounds.back().warnings;
    DOCTEST_CHECK(std::any_of(warnings.begin(), warnings.end(), [&](const auto& warning) {
        return warning.find("your picture of " + target.name) != std::string::npos;
    }));
    DOCTEST_REQUIRE(session.until([&] { return model.estimate.server_pictures == 6; }));
    DOCTEST_CHECK(model.estimate.server_seconds > 0);
    session.app.run(command::DiscardResult{});
    choice.target_picture.clear();
    session.app.run(command::SetServer{choice});
    DOCTEST_CHECK(model.server.choice.target_picture.empty());
    session.app.shut_down();
}

DOCTEST_TEST_CASE("a picture in the making is shown beside what was sent, and goes when it has come") {
    if (!can_draw()) return;
    Asked asked("forge", {{"draw_s", "1.6"}, {"previews", "1"}});
    auto& session = asked.session;
    auto& server = asked.server;
    const auto& model = asked.model;
    asked.agree();
    std::size_t shown = 0, hidden = 0, measured = 0;
    std::shared_ptr<const Image> last;
    DOCTEST_REQUIRE(session.until([&] {
        const auto& [sent, preview] = model.drawing;
        DOCTEST_CHECK((sent == nullptr) == (preview == nullptr));
        if (preview && preview != last) ++shown;
        if (last && !preview) ++hidden;
        last = preview;
        if (sent) DOCTEST_CHECK(sent->width == 8 * preview->width);
        if (model.job.running && model.estimate.server_seconds > 0) ++measured;
        return !model.job.running;
    }));
    DOCTEST_CHECK(model.job.error == "");
    DOCTEST_CHECK(shown == 4);
    DOCTEST_CHECK(hidden == 4);
    DOCTEST_CHECK(model.drawing.preview == nullptr);
    DOCTEST_CHECK(measured > 0);  // of the pictures that had come by then
    session.app.run(command::DiscardResult{});
    server.set({{"draw_s", "20"}});
    asked.edit_again();
    DOCTEST_REQUIRE(session.until([&] { return model.drawing.preview != nullptr; }));
    session.app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.drawing.preview == nullptr);
}

DOCTEST_TEST_CASE(
    "the time that a server's pictures take is known again after a restart, until it is forgotten") {
    if (!can_draw()) return;
    const Place place;
    remote::StandIn server("sdserver");
    {
        Session session;
        ask_server(session, server);
        session.app.run(command::Answer{0});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_REQUIRE(session.until([&] { return session.app.model().estimate.server_seconds > 0; }));
        session.app.run(command::DiscardResult{});
        session.app.shut_down();
    }
    const auto asked = server.log().size();
    Session again;
    again.open_bear();
    ask_for_iridescence(again);
    again.app.run(command::UseServer{true});
    const auto& estimate = again.app.model().estimate;
    DOCTEST_REQUIRE(again.until([&] { return estimate.server_pictures == 4; }));
    DOCTEST_CHECK(estimate.server_seconds > 0);
    auto choice = again.app.model().server.choice;
    choice.side = 256;  // another size takes another time
    again.app.run(command::SetServer{choice});
    DOCTEST_REQUIRE(again.until([&] { return estimate.server_seconds < 0; }));
    choice.side = 128;
    again.app.run(command::SetServer{choice});
    DOCTEST_REQUIRE(again.until([&] { return estimate.server_seconds > 0; }));
    DOCTEST_CHECK(server.log().size() == asked);
    server.set({{"model", "another"}});  // has taken no time here yet
    again.app.run(command::TestServer{});
    DOCTEST_REQUIRE(again.idle());
    DOCTEST_REQUIRE(again.until([&] { return estimate.server_seconds < 0; }));
    again.app.run(command::ForgetServer{});
    choose(again, server.url());
    again.app.run(command::UseServer{true});
    DOCTEST_REQUIRE(
        again.until([&] { return estimate.server_pictures == 4 && estimate.server_seconds < 0; }));
    again.app.shut_down();
}

DOCTEST_TEST_CASE("a search by the model here has the server draw nothing, not even for the estimate") {
    if (!can_draw()) return;
    Asked asked;
    asked.session.app.run(command::Answer{1});
    asked.session.app.run(command::Locate{});
    asked.agree();
    DOCTEST_REQUIRE(asked.session.idle());
    DOCTEST_CHECK(asked.model.job.error == "");
    DOCTEST_CHECK(asked.model.labelled > 0);
    DOCTEST_CHECK(asked.server.asked("/img_gen").empty());
}

DOCTEST_TEST_CASE("a thing without a word is found by the server, after a click that says what goes where") {
    if (!can_draw()) return;
    const Place place;
    remote::StandIn server("sdserver");
    server.set({{"model", "flux1-kontext-dev"}, {"edits", "red"}});
    Session session;
    const auto& model = session.app.model();
    session.open_bear();
    auto request = model.request;
    request.source = "gizmo", request.prompt = "a golden gizmo", request.target = "golden";
    request.quality = "draft", request.method = "auto", request.views = 12;
    session.app.run(command::SetRequest{request});
    choose_small(session, server.url());
    session.app.update(session.preview);
    DOCTEST_CHECK(model.server_search.empty());
    session.app.run(command::Locate{false, true});  // nothing was offered
    DOCTEST_CHECK_FALSE(model.job.running);
    session.app.run(command::UseServer{true});
    DOCTEST_REQUIRE(session.until([&] { return !model.server_search.empty(); }));
    for (const std::string words :
         {"\"gizmo\"", "16 pictures", "\"a golden gizmo\"", "127.0.0.1", "this machine"})
        DOCTEST_CHECK(model.server_search.find(words) != std::string::npos);
    DOCTEST_CHECK(server.log().empty());
    session.app.run(command::Locate{false, true});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.job.error == "");
    DOCTEST_CHECK(questions(session) == 0);
    const auto asked = server.asked("/img_gen");
    DOCTEST_CHECK((asked.size() == 16 || asked.size() == 32));
    for (const auto& one : asked) DOCTEST_CHECK_FALSE(one["json"].contains("mask_image"));
    DOCTEST_CHECK(model.attention.size() == 8);
    DOCTEST_CHECK(model.attention_mode.find("the server changed") != std::string::npos);
    DOCTEST_REQUIRE(model.document->state().labels.size() == 1);
    DOCTEST_CHECK(model.document->state().labels[0].name == "gizmo");
    DOCTEST_CHECK(model.labelled > 100);
    DOCTEST_REQUIRE(session.until([&] { return model.labelled_by_hand; }));
    DOCTEST_CHECK_FALSE(model.server_search.empty());  // what was found may be wrong
    request.prompt = "a blue gizmo", request.target = "blue";
    session.app.run(command::SetRequest{request});
    DOCTEST_REQUIRE(
        session.until([&] { return model.server_search.find("a blue gizmo") != std::string::npos; }));
    session.app.run(command::Locate{false, true});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.job.error == "");
    DOCTEST_CHECK(server.asked("/img_gen").size() >= asked.size() + 16);
    DOCTEST_CHECK(model.document->state().labels.size() == 1);  // in place of the first
    for (int step = 0; step < 2; ++step) session.app.run(command::Undo{});
    DOCTEST_CHECK(model.document->state().labels.empty());
    session.app.update(session.preview);
    DOCTEST_CHECK_FALSE(model.server_search.empty());
    session.app.run(command::Redo{});
    request.prompt = "a golden gizmo", request.target = "golden";
    session.app.run(command::SetRequest{request});
    session.app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(model.job.error == "");
    DOCTEST_REQUIRE(model.result_waiting);
    DOCTEST_CHECK(model.result_changed_outside == 0);
    DOCTEST_CHECK(server.asked("/img_gen").size() > asked.size());
    session.app.run(command::DiscardResult{});
    session.app.shut_down();
}

DOCTEST_TEST_CASE(
    "no server is offered for a known word, an addition, a label, or a public address in silence") {
    if (!can_ask()) return;
    const Place place;
    Session session;
    const auto& model = session.app.model();
    session.open_bear();
    choose(session, "http://203.0.113.9:7860");
    session.app.run(command::UseServer{true});
    const auto offer = [&](const std::string& source, const std::string& prompt, const std::string& target) {
        auto request = model.request;
        request.source = source, request.prompt = prompt, request.target = target, request.method = "auto";
        session.app.run(command::SetRequest{request});
        session.app.update(session.preview);
        return model.server_search;
    };
    DOCTEST_CHECK(offer("gizmo", "a golden gizmo", "golden").find("public address") != std::string::npos);
    DOCTEST_CHECK(offer("bear", "a golden bear", "golden").empty());
    DOCTEST_CHECK(offer("gizmo", "a gizmo wearing a red hat", "red hat").empty());
    DOCTEST_CHECK_FALSE(offer("gizmo", "a golden gizmo", "golden").empty());
    session.label_the_middle();
    session.app.update(session.preview);
    DOCTEST_CHECK(model.server_search.empty());
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
