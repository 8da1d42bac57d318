// Evidence of a search: views that come in while it looks, and views that are left out of the vote.
#include <algorithm>

#include "tests/ui/app/session.h"

namespace evidence_test {

using namespace gse;
using namespace gse::test;

namespace {

const NamedLabel& active(const app::Application& app) {
    const auto& state = app.document().state();
    return state.labels.at(static_cast<std::size_t>(state.active_label));
}

}  // namespace

DOCTEST_TEST_CASE("views come in while a search looks; one can be left out, put back, undone and redone") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.run(command::Locate{});
    bool some = false;  // were there while it still looked
    DOCTEST_REQUIRE(session.until([&] {
        const auto& views = app.model().attention;
        const bool here =
            std::any_of(views.begin(), views.end(), [](const auto& view) { return view.render != nullptr; });
        some |=
            app.model().attention_arriving && app.model().job.running && here && app.model().labelled == 0;
        return !app.model().job.running;
    }));
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(some);
    DOCTEST_CHECK_FALSE(app.model().attention_arriving);
    DOCTEST_REQUIRE(app.model().attention.size() == 8);
    const auto all = *active(app).weight;
    const auto at = app.document().position();
    const auto render = app.model().attention[2].render;
    app.run(command::LeaveOutView{2, true});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.document().names().back() == "Leave out " + app.model().attention[2].name);
    DOCTEST_CHECK(app.document().position() == at + 1);
    DOCTEST_CHECK(app.model().attention[2].step == edit::ViewStep::LeftOut);
    DOCTEST_CHECK(app.model().attention[2].render == render);  // what is on the screen stays
    DOCTEST_CHECK(app.model().request.excluded_views == "2");
    const auto without = *active(app).weight;
    DOCTEST_CHECK(without != all);
    app.run(command::Undo{});
    DOCTEST_CHECK(*active(app).weight == all);
    DOCTEST_CHECK(app.model().request.excluded_views.empty());
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().attention[2].step != edit::ViewStep::LeftOut);  // the evidence follows
    DOCTEST_CHECK(app.document().position() == at);
    app.run(command::Redo{});
    DOCTEST_CHECK(*active(app).weight == without);
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().attention[2].step == edit::ViewStep::LeftOut);
    app.run(command::LeaveOutView{2, false});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(*active(app).weight == all);  // to the bit
    DOCTEST_CHECK(app.document().names().back() == "Put back " + app.model().attention[2].name);
    app.run(command::LeaveOutView{5, true});
    DOCTEST_REQUIRE(session.settled());
    auto request = app.model().request;
    request.prompt = "a red bear on the grass", request.target = "red";
    app.run(command::SetRequest{request});
    DOCTEST_CHECK(app.model().request.excluded_views.empty());  // another search has other views
}

DOCTEST_TEST_CASE("a search that is stopped gives back the views of the one before") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.settled());
    const auto map = *app.model().attention[1].map;
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.until([&] { return app.model().attention_arriving; }));
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK_FALSE(app.model().attention_arriving);
    DOCTEST_REQUIRE(app.model().attention.size() == 8);
    DOCTEST_CHECK(app.model().attention[1].map->data == map.data);
    DOCTEST_CHECK(app.model().job.error.empty());
}

}  // namespace evidence_test
