// Several results of one edit, of which one is applied.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/session/application.h"
#include "tests/ui/app/session.h"

namespace results_test {

using namespace gse;
using namespace gse::test;

namespace {

/// With the bear and a quick edit.
app::Application& opened(Session& session) {
    session.open_bear();
    auto request = session.app.model().request;
    request.method = "views";
    request.edited_views = 2;
    session.app.run(command::SetRequest{request});
    return session.app;
}

}  // namespace

DOCTEST_TEST_CASE(
    "one more result with another seed: each can be shown and applied, and a stopped one takes none away") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session);
    app.run(command::AnotherResult{});  // of nothing
    DOCTEST_CHECK_FALSE(app.model().job.running);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    const auto seed = app.model().request.seed;
    const auto base = app.document().state().current, first = session.preview.last.set;
    app.run(command::AnotherResult{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().results.size() == 2);
    DOCTEST_CHECK(app.model().request.seed == seed + 1);
    const auto second = session.preview.last.set;
    DOCTEST_CHECK_FALSE(second.shares_all_with(first));
    app.run(command::AnotherResult{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().edit_running; }));
    DOCTEST_CHECK_FALSE(app.model().result_waiting);
    DOCTEST_CHECK(app.model().unsaved);
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().results.size() >= 2);
    DOCTEST_REQUIRE(app.model().result_waiting);  // stopped before its first step, or after some
    app.run(command::ShowResult{0});
    app.update(session.preview);
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(first));
    DOCTEST_CHECK(app.model().request.seed == seed);
    app.run(command::ApplyResult{});
    app.update(session.preview);
    const auto& state = app.document().state();
    DOCTEST_REQUIRE(state.stack.size() == 1);
    DOCTEST_CHECK(nlohmann::ordered_json::parse(state.stack[0].recipe)["request"]["seed"] == seed);
    DOCTEST_CHECK_FALSE(state.current.shares_all_with(base));
    DOCTEST_CHECK(app.model().results.empty());
}

DOCTEST_TEST_CASE(
    "one more result, and all of them discarded: the scene and what is tinted are as before the first") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session);
    auto view = app.model().view;
    view.tint_labels = true;
    app.run(command::SetViewSettings{view});
    const auto base = app.document().state().current;
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    app.run(command::AnotherResult{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().results.size() == 2);
    DOCTEST_CHECK_FALSE(app.model().view.tint_labels);
    app.run(command::DiscardResult{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().results.empty());
    DOCTEST_CHECK(app.model().view.tint_labels);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(base));
}

DOCTEST_TEST_CASE("variations stay after Apply, and one is exchanged for the applied one; each is one step") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    const auto first = session.preview.last.set;
    app.run(command::AnotherResult{});
    DOCTEST_REQUIRE(session.idle());
    const auto second = session.preview.last.set;
    app.run(command::ApplyResult{});
    app.update(session.preview);
    const auto colours = [](const GaussianSet& set) {
        return std::vector<float>(set.sh().begin(), set.sh().end());
    };
    const auto shown = [&] { return colours(app.document().state().current); };
    DOCTEST_REQUIRE(app.model().variations.size() == 1);
    const auto edit = app.model().variations[0].edit;
    DOCTEST_CHECK(app.model().variations[0].results.size() == 2);
    DOCTEST_CHECK(app.model().variations[0].applied == 1);
    DOCTEST_REQUIRE(shown() == colours(second));
    const auto position = app.document().position();
    app.run(command::ExchangeVariation{edit, 0});
    app.update(session.preview);
    DOCTEST_CHECK(shown() == colours(first));
    DOCTEST_CHECK(app.model().variations[0].applied == 0);
    DOCTEST_CHECK(app.document().state().stack.size() == 1);
    DOCTEST_CHECK(app.document().position() == position + 1);
    app.run(command::ExchangeVariation{edit, 0});  // it is the applied one already
    app.run(command::ExchangeVariation{edit, 9});
    DOCTEST_CHECK(app.document().position() == position + 1);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(shown() == colours(second));
    DOCTEST_CHECK(app.model().variations[0].applied == 1);
    app.run(command::Undo{});  // the edit itself
    app.update(session.preview);
    DOCTEST_CHECK(app.model().variations.empty());
    app.run(command::Redo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().variations.size() == 1);
    app.run(command::SaveProject{place.folder / "with.gsep"});
    DOCTEST_REQUIRE(session.idle());
    {
        Session again;  // the project keeps them
        again.app.run(command::Open{place.folder / "with.gsep"});
        DOCTEST_REQUIRE(again.until([&] { return again.app.model().variations.size() == 1; }, 60));
        DOCTEST_CHECK(again.app.model().variations[0].applied == 1);
        DOCTEST_REQUIRE(again.app.model().variations[0].results.size() == 2);
        DOCTEST_CHECK(again.app.model().variations[0].results[0].thumbnail != nullptr);
        again.app.run(command::ExchangeVariation{edit, 0});
        again.app.update(again.preview);
        DOCTEST_CHECK(colours(again.app.document().state().current) == colours(first));
    }
    app.run(command::SetEditStrength{edit, 0.5, true});
    app.run(command::ExchangeVariation{edit, 0});
    DOCTEST_CHECK(app.document().state().stack[0].strength == 0.5);  // the artist's
    app.shut_down();
}

DOCTEST_TEST_CASE("an edit that Esc stopped tells so, with the time of its own line") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 5000;
    app.run(command::SetRequest{request});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().losses.size() > 3; }));
    app.run(command::Pause{true});
    session.until([] { return false; }, 0.5);  // a pause is no work
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    DOCTEST_CHECK(app.model().verdict.stopped_at >= 0);
    DOCTEST_CHECK(app.model().job.outcome == "stopped");
    DOCTEST_CHECK(app.model().result_seconds == app.model().job.seconds);
    app.shut_down();
}

}  // namespace results_test
