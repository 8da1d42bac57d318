// Redrawn views in the application: the edit waits for the artist and takes orders. Branches go on with
// redrawn views. Estimates stand beside the time that edits took.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/session/application.h"
#include "engine/base/process_memory.h"
#include "tests/ui/app/session.h"

namespace targets_test {

using namespace gse;
using namespace gse::test;
using edit::TargetChoice;

namespace {

/// The sample, to be edited by redrawn views.
void ask_for_views(Session& session, bool review, int fit_steps) {
    session.open_bear();
    auto request = session.app.model().request;
    request.method = "views";
    request.edited_views = 4;
    request.view_steps = 2;
    request.fit_steps = fit_steps;
    session.app.run(command::SetRequest{request});
    auto settings = session.app.model().model_settings;
    settings.review = review;
    settings.gate = false;
    session.app.run(command::SetModelSettings{settings});
}

}  // namespace

DOCTEST_TEST_CASE(
    "an edit waits until the artist has looked at the redrawn views, and takes what is said of them") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = session.app;
    const auto& model = app.model();
    ask_for_views(session, true, 12);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return model.targets_wait; }));
    DOCTEST_REQUIRE(model.target_rounds.size() == 1);
    DOCTEST_REQUIRE(model.target_rounds[0].targets.size() == 4);
    const auto view = [&](std::size_t i) { return model.target_rounds.back().targets[i]; };
    const auto first = view(1).after;
    app.run(command::OrderTarget{{0, view(0).view, TargetChoice::Drop}});
    app.run(command::OrderTarget{{0, view(1).view, TargetChoice::Redo}});
    session.app.update(session.preview);
    DOCTEST_REQUIRE(session.until([&] { return view(0).dropped && view(1).attempt == 1; }, 60));
    DOCTEST_CHECK(view(1).after->data != first->data);
    DOCTEST_CHECK(model.targets_wait);
    DOCTEST_CHECK(model.losses.empty());
    app.run(command::FitToTargets{});
    DOCTEST_REQUIRE(session.until([&] { return model.result_waiting; }));
    DOCTEST_CHECK(model.job.error.empty());
    DOCTEST_CHECK(model.losses.size() == 12);
    DOCTEST_CHECK(model.cost.unet > 0);
    DOCTEST_CHECK(model.cost.tflop > 0);
    DOCTEST_CHECK(!model.targets_wait);
    DOCTEST_CHECK(view(0).dropped);                                          // still to be seen
    app.run(command::OrderTarget{{0, view(0).view, TargetChoice::Accept}});  // too late: said, not done
    DOCTEST_CHECK(session.until(
        [&] { return !model.toasts.empty() && model.toasts.back().text.find("over") != std::string::npos; },
        5));
    app.run(command::DiscardResult{});
    // Cancelled while it waits.
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return model.targets_wait; }));
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
    session.app.update(session.preview);
    DOCTEST_CHECK(!model.result_waiting);
    DOCTEST_CHECK(!model.targets_wait);
}

DOCTEST_TEST_CASE("a branch out of a fit asks the networks nothing") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = session.app;
    const auto& model = app.model();
    ask_for_views(session, false, 100000);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return model.snapshots.size() >= 2; }));
    DOCTEST_CHECK(model.cost.unet > 0);
    const auto pictures = model.target_rounds.back().targets;
    const int from = model.snapshots[0].iteration;
    auto request = model.request;
    request.fit_steps = from + 10;
    app.run(command::SetRequest{request});
    app.run(command::BranchFromSnapshot{from});
    DOCTEST_REQUIRE(session.until([&] { return model.result_waiting; }));
    DOCTEST_CHECK(model.losses.back().iteration == from + 9);
    DOCTEST_CHECK(model.cost.unet == 0);
    DOCTEST_REQUIRE(model.target_rounds.size() == 1);
    DOCTEST_CHECK(model.target_rounds[0].targets[2].after->data == pictures[2].after->data);
}

DOCTEST_TEST_CASE("a search after a discarded edit shows the scene, not what the edit left behind") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = session.app;
    const auto& model = app.model();
    ask_for_views(session, false, 100000);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] { return !model.snapshots.empty(); }));
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.until([&] { return model.result_waiting && !model.job.running; }));
    app.run(command::DiscardResult{});
    app.update(session.preview);
    const GaussianSet scene = session.preview.last.set;
    auto request = model.request;
    request.source = "grass";
    request.prompt = "a bear on the snow";
    app.run(command::SetRequest{request});
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.until([&] { return model.job.running; }, 60));
    auto view = model.view;
    view.mode = static_cast<int>(ui::DisplayMode::Depth);
    app.run(command::SetViewSettings{view});
    app.update(session.preview);
    DOCTEST_REQUIRE(model.job.running);
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(scene));
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.idle());
}

DOCTEST_TEST_CASE("what an edit is estimated to take after the search, beside what it takes") {
    if (!networks()) return;
    const Place place;
    for (const char* method : {"views", "sds"}) {
        Session session;
        auto& app = session.app;
        const auto& model = app.model();
        session.open_bear();
        auto request = model.request;
        request.method = method;
        request.iterations = 60;
        request.image_size = 96;
        app.run(command::SetRequest{request});
        app.run(command::Locate{});
        DOCTEST_REQUIRE(session.idle());
        session.until([] { return false; }, 1.2);  // the estimate is refreshed
        const ui::Estimate estimate = model.estimate;
        DOCTEST_CHECK(estimate.seconds > 0);
        DOCTEST_CHECK(estimate.memory_mb > current_rss_mb() * 0.9);
        const PeakMemory peak;
        app.run(command::Edit{});
        DOCTEST_REQUIRE(session.until([&] { return model.result_waiting; }));
        DOCTEST_MESSAGE(std::string(method)
                        << ": estimated " << estimate.seconds << " s, " << estimate.tflop << " TFLOP, "
                        << estimate.memory_mb << " MB; took " << model.job.seconds << " s, "
                        << model.cost.tflop << " TFLOP, " << peak.mb() << " MB");
        // Passes can be foreseen; how many masks follow the edit cannot quite.
        DOCTEST_CHECK(estimate.tflop == doctest::Approx(model.cost.tflop).epsilon(0.25));
        DOCTEST_CHECK(estimate.memory_mb > 0.75 * peak.mb());
        DOCTEST_CHECK(estimate.memory_mb < 1.5 * peak.mb());
        // Other work on the machine comes and goes: this only asks for the order of magnitude.
        constexpr double busy = 10;
        DOCTEST_CHECK(estimate.seconds < busy * model.job.seconds);
        DOCTEST_CHECK(estimate.seconds > model.job.seconds / busy);
        app.run(command::DiscardResult{});
    }
}

}  // namespace targets_test
