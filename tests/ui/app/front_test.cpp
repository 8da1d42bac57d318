// The side that the artist turned to is what a search goes by where its pictures are not sure of a front.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/pipeline/run/views.h"
#include "tests/ui/app/session.h"

namespace front_test {

using namespace gse;
using namespace gse::test;

namespace {

/// The scene from a side that it is not shown from first.
Camera turned(const app::Application& app, double degrees) {
    return orbit_camera(app.model().orbit, degrees * pipeline::Degree, 320, 240);
}

}  // namespace

DOCTEST_TEST_CASE(
    "a search takes the side that the scene was turned to with it, and looking at what it found begins no "
    "other") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 2;
    app.run(command::SetRequest{request});
    const auto looked = [&] { return app.document().state().labels.at(0).looked_from; };
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(looked().empty());  // nobody has turned to a side
    app.run(command::SetCamera{turned(app, 90)});
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(looked() == "90");
    DOCTEST_REQUIRE(app.model().search.front.has_value());
    const double away = std::abs(std::remainder(*app.model().search.front, 360));
    DOCTEST_CHECK(away < 45);  // the pictures of the bear are sure
    const auto searches = app.model().search.number;
    app.run(command::SetCamera{turned(app, 200)});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.model().result_waiting);
    DOCTEST_CHECK(app.model().search.number == searches);
    app.shut_down();
}

}  // namespace front_test
