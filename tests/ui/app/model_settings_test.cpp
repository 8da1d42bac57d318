// Settings that a chosen model brings with it, and tunings that it learns of a scene, in the artist's window.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/file.h"
#include "tests/ui/app/session.h"
#include "ui/model/model_settings.h"

namespace model_settings_test {

using namespace gse;
using namespace gse::test;

namespace {

/// A copy of the starter that states settings of its own.
fs::path model_that_states(const Place& place, const std::string& name, const nlohmann::json& profile) {
    const auto model = place.folder / name;
    fs::copy(app::starter_model_path(), model, fs::copy_options::recursive);
    fs::permissions(model / "gseditpro.json", fs::perms::owner_all);
    auto facts = nlohmann::json::parse(read_file(model / "gseditpro.json"));
    facts["profile"] = profile;
    write_file(model / "gseditpro.json", facts.dump());
    return model;
}

}  // namespace

DOCTEST_TEST_CASE("a model's settings are taken where the artist changed nothing, and given up with it") {
    if (!networks()) return;
    const Place place;
    const auto stating = model_that_states(
        place, "stating", {{"request", {{"tau", 0.6}, {"views", 5}}}, {"dreambooth", {{"steps", 333}}}});
    const auto wrong = model_that_states(place, "wrong", {{"request", {{"tao", 0.6}}}});
    const edit::EditRequest usual;
    {
        Session session;
        session.open_bear();  // with 8 views
        auto& app = session.app;
        const auto steps = app.model().model_settings.learning.steps;
        app.run(command::ChooseModel{stating.string()});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().request.label_threshold == 0.6);
        DOCTEST_CHECK(app.model().request_defaults.views == 5);
        DOCTEST_CHECK(app.model().model_settings_defaults.learning.steps == 333);
        DOCTEST_CHECK(app.model().request.views == 8);
        DOCTEST_CHECK(app.model().request.prompt == "a blue bear on the grass");
        DOCTEST_CHECK(app.model().model_settings.learning.steps == 333);
        app.run(command::ChooseModel{app::starter_model_path().string()});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().request.label_threshold == usual.label_threshold);
        DOCTEST_CHECK(app.model().request_defaults.views == usual.views);
        DOCTEST_CHECK(app.model().request.views == 8);
        DOCTEST_CHECK(app.model().model_settings.learning.steps == steps);
        app.run(command::ChooseModel{wrong.string()});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().toasts.back().text.find("\"tao\"") != std::string::npos);
        DOCTEST_CHECK(app.model().request.label_threshold == usual.label_threshold);
        app.run(command::ChooseModel{stating.string()});
        DOCTEST_REQUIRE(session.settled());
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().request.label_threshold == 0.6);
    DOCTEST_CHECK(again.app.model().request.views == 5);
}

DOCTEST_TEST_CASE(
    "what the window says of guidance, attention, learning and front is in the recipe and in the project") {
    if (!networks()) return;
    const Place place;
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        auto settings = app.model().model_settings;
        settings.front = "45";
        settings.threads = 2;
        settings.guidance.guidance_scale = 6;
        settings.attention.strength = 0.5;
        settings.learning.batch = 1;
        app.run(command::SetModelSettings{settings});
        auto request = app.model().request;
        request.iterations = 2;
        request.views = 6;
        request.edited_views = 2;
        app.run(command::SetRequest{request});
        app.run(command::Edit{});
        DOCTEST_REQUIRE(session.idle());
        DOCTEST_CHECK(app.model().job.error.empty());
        app.run(command::ApplyResult{});
        const auto recipe = nlohmann::ordered_json::parse(app.document().state().stack[0].recipe);
        DOCTEST_CHECK(recipe["job"]["front"] == "45");
        DOCTEST_CHECK(recipe["job"]["threads"] == 2);
        DOCTEST_CHECK(recipe["guidance"]["guidance_scale"] == 6);
        DOCTEST_CHECK(recipe["attention"]["strength"] == 0.5);
        app.run(command::SaveProject{place.folder / "bear.gsep"});
        DOCTEST_REQUIRE(session.idle());
        app.shut_down();
    }
    Session again;
    again.app.run(command::Open{place.folder / "bear.gsep"});
    DOCTEST_REQUIRE(again.until([&] { return again.app.model().document != nullptr; }));
    const auto& settings = again.app.model().model_settings;
    DOCTEST_CHECK(settings.front == "45");
    DOCTEST_CHECK(settings.guidance.guidance_scale == 6);
    DOCTEST_CHECK(settings.attention.strength == 0.5);
    DOCTEST_CHECK(settings.learning.batch == 1);
    again.app.shut_down();
}

DOCTEST_TEST_CASE("settings of the first projects are read, wrong ones are refused by name") {
    const auto old =
        ui::model_settings_from_json({{"learn_steps", 31}, {"learn_rank", 4}, {"gate", false}}, {});
    DOCTEST_CHECK(old.learning.steps == 31);
    DOCTEST_CHECK(old.learning.rank == 4);
    DOCTEST_CHECK(!old.gate);
    const auto round = ui::model_settings_from_json(ui::model_settings_to_json(old), {});
    DOCTEST_CHECK(ui::model_settings_to_json(round) == ui::model_settings_to_json(old));
    for (const auto& wrong : {nlohmann::ordered_json{{"guidance", {{"clamp", -1}}}},
                              nlohmann::ordered_json{{"device", 7}}, nlohmann::ordered_json{{"learn", true}}})
        DOCTEST_CHECK_THROWS_AS(ui::model_settings_from_json(wrong, {}), Error);
}

DOCTEST_TEST_CASE(
    "a scene is learned once for the same words and settings, and only where it was asked for") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    const auto tunings = [&] {
        return std::count_if(app.model().log.begin(), app.model().log.end(),
                             [](const auto& line) { return line.text.starts_with("tuned in"); });
    };
    const auto search = [&](bool learns, auto change) {
        auto settings = app.model().model_settings;
        settings.learn_scene = learns;
        settings.learning.steps = 1;
        settings.learning.class_images = 2;
        app.run(command::SetModelSettings{settings});
        auto request = app.model().request;
        change(request);
        app.run(command::SetRequest{request});
        app.run(command::Locate{});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().job.error.empty());
    };
    search(false, [](auto& request) { request.attention_repeats = 1; });
    DOCTEST_CHECK(tunings() == 0);
    search(true, [](auto&) {});
    DOCTEST_CHECK(tunings() == 1);
    search(true,
           [](auto& request) { request.positive_points = 4; });  // another search, the same scene and words
    DOCTEST_CHECK(tunings() == 1);
    search(true, [](auto& request) { request.views = 6; });
    DOCTEST_CHECK(tunings() == 2);
}

}  // namespace model_settings_test
