// A polish behind redrawn views: it pulls at their end only, and stays only where views that were not redrawn
// come nearer.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <deque>

#include "engine/base/log.h"
#include "engine/edit/optimise/oracle_guidance.h"
#include "engine/edit/target_views/view_round.h"
#include "tests/unit/edit/view_oracle.h"

namespace polish_test {

namespace {

using namespace gse;

constexpr int FitSteps = 6, PolishSteps = 12;

edit::EditRequest polished_request(int polish_steps = PolishSteps) {
    auto request = test::view_request(1, FitSteps);
    request.polish_steps = polish_steps;
    request.densify_every = 0;
    return request;
}

/// The edit of a ball whose polish is led by `pull`.
struct Polishing : test::Redrawing {
    edit::Guidance& pull;
    edit::EditTools polishing{*rasterizer, pull, {}, {}};
    explicit Polishing(edit::Guidance& guidance) : pull(guidance) { polishing.views = &oracle; }
    edit::EditResult polished(const edit::EditRequest& request) {
        return edit::run_edit(scene.set, plan, request, polishing);
    }
};

}  // namespace

DOCTEST_TEST_CASE("a polish that brings held-out views nearer is kept; what came before it is the same") {
    test::Redrawing plain;
    edit::OracleGuidance oracle(plain.target, plain.plan.views, {}, *plain.rasterizer);
    std::vector<int> iterations, counts;
    test::FunctionGuidance pull([&](const edit::GuidanceInput& input) {
        iterations.push_back(input.iteration);
        counts.push_back(input.iteration_count);
        return oracle.evaluate(input);
    });
    Polishing run(pull);
    const auto before = plain.edited(polished_request(0));
    const auto result = run.polished(polished_request());
    DOCTEST_REQUIRE(result.polish);
    DOCTEST_CHECK(result.polish->kept);
    DOCTEST_CHECK(result.polish->steps == PolishSteps);
    DOCTEST_CHECK(result.polish->after < result.polish->before);
    DOCTEST_CHECK(run.error_of(result.set) < run.error_of(before.set));
    DOCTEST_CHECK(result.changed_outside_label == 0);
    DOCTEST_CHECK(!before.polish);
    DOCTEST_REQUIRE(result.history.size() == FitSteps + PolishSteps);
    DOCTEST_CHECK(edit::loop_steps(polished_request(), edit::EditMode::Modify) == FitSteps + PolishSteps);
    for (std::size_t i = 0; i < before.history.size(); ++i)
        DOCTEST_CHECK(result.history[i].preservation == before.history[i].preservation);
    DOCTEST_REQUIRE(iterations.size() == PolishSteps);
    DOCTEST_CHECK(iterations.front() == 0);
    DOCTEST_CHECK(iterations.back() == PolishSteps - 1);
    DOCTEST_CHECK(counts.front() == PolishSteps);
    // Two views that the round did not ask for, as it began.
    DOCTEST_REQUIRE(run.oracle.asked.size() == 2);
    DOCTEST_CHECK(run.oracle.asked[1].size() == edit::HeldOutViews);
    DOCTEST_CHECK(run.oracle.inputs[1].strength == run.oracle.inputs[0].strength);
    DOCTEST_CHECK(run.oracle.inputs[1].seed != run.oracle.inputs[0].seed);
    for (const auto& held : run.oracle.asked[1]) {
        for (const auto& drawn : run.oracle.asked[0]) DOCTEST_CHECK(held.view.name != drawn.view.name);
        DOCTEST_CHECK(held.rendered.data == held.original.data);
    }
    DOCTEST_CHECK(result.redrawn_views == before.redrawn_views);
}

DOCTEST_TEST_CASE("a polish that leads away is dropped again, bit by bit") {
    auto away = test::towards({0.9, 0.1, 0.1});
    Polishing run(away);
    const auto result = run.polished(polished_request());
    DOCTEST_REQUIRE(result.polish);
    DOCTEST_CHECK(!result.polish->kept);
    DOCTEST_CHECK(result.polish->after >= result.polish->before);
    test::Redrawing plain;
    DOCTEST_CHECK(test::same_bytes(result.set, plain.edited(polished_request(0)).set));
    DOCTEST_CHECK(result.iterations == FitSteps + PolishSteps);
    DOCTEST_CHECK(!result.stopped);
}

DOCTEST_TEST_CASE("where every view is redrawn nothing tells whether a polish helps, and there is none") {
    test::Redrawing run;  // its guidance throws when it is asked
    auto request = polished_request();
    request.edited_views = static_cast<int>(run.plan.views.size());
    log::set_level(log::Level::Off);
    const auto result = run.edited(request);
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(!result.polish);
    DOCTEST_CHECK(!result.stopped);
    DOCTEST_CHECK(!result.failure);
    DOCTEST_CHECK(result.iterations == FitSteps);
    request.polish_steps = 0;
    test::Redrawing plain;
    DOCTEST_CHECK(test::same_bytes(result.set, plain.edited(request).set));
}

DOCTEST_TEST_CASE(
    "a polish that is stopped is judged by what it came to, and goes on from a snapshot without redrawing "
    "the round") {
    std::stop_source stop;
    test::Redrawing scenes;
    edit::OracleGuidance oracle(scenes.target, scenes.plan.views, {}, *scenes.rasterizer);
    int left = 5;
    test::FunctionGuidance pull([&](const edit::GuidanceInput& input) {
        if (--left == 0) stop.request_stop();
        return oracle.evaluate(input);
    });
    Polishing run(pull);
    run.polishing.job.stop = stop.get_token();
    std::deque<edit::EditSnapshot> snapshots;
    run.polishing.snapshot = [&](edit::EditSnapshot snapshot) { snapshots.push_back(std::move(snapshot)); };
    auto request = polished_request();
    request.snapshot_every = 1;
    const auto stopped = run.polished(request);
    DOCTEST_CHECK(stopped.stopped);
    DOCTEST_REQUIRE(stopped.polish);
    DOCTEST_CHECK(stopped.polish->steps == 5);
    DOCTEST_CHECK(stopped.polish->kept);
    DOCTEST_REQUIRE(snapshots.size() == FitSteps + 5);

    Polishing again(oracle);
    again.polishing.start = &snapshots.back();
    const auto result = again.polished(request);
    DOCTEST_REQUIRE(result.polish);
    DOCTEST_CHECK(result.iterations == FitSteps + PolishSteps);
    DOCTEST_CHECK(result.polish->steps == PolishSteps - 5);
    DOCTEST_REQUIRE(again.oracle.asked.size() == 1);  // the views that it is judged by
    DOCTEST_CHECK(again.oracle.asked[0].size() == edit::HeldOutViews);
    DOCTEST_CHECK(again.error_of(result.set) < again.error_of(stopped.set));
}

DOCTEST_TEST_CASE("a polish in the middle of which memory runs out leaves the state before it") {
    test::Redrawing scenes;
    edit::OracleGuidance oracle(scenes.target, scenes.plan.views, {}, *scenes.rasterizer);
    test::FunctionGuidance pull([&](const edit::GuidanceInput& input) {
        if (input.iteration == 3) throw OutOfMemory("the pull");
        return oracle.evaluate(input);
    });
    Polishing run(pull);
    const auto result = run.polished(polished_request());
    DOCTEST_CHECK(result.shortage);
    DOCTEST_CHECK(test::same_bytes(result.set, scenes.edited(polished_request(0)).set));
}

DOCTEST_TEST_CASE("a polish begins anew with a label that is corrected in its middle") {
    auto away = test::towards({0.9, 0.1, 0.1});
    Polishing run(away);
    std::vector<std::uint8_t> half = run.scene.first;
    for (std::size_t row = 0; row < half.size() / 4; ++row) half[row] = 0;
    int asked = 0;
    run.polishing.new_label = [&]() -> std::optional<std::vector<std::uint8_t>> {
        return asked++ == FitSteps + 4 ? std::optional(half) : std::nullopt;
    };
    const auto result = run.polished(polished_request());
    DOCTEST_CHECK(result.label_changes == 1);
    DOCTEST_REQUIRE(result.polish);
    DOCTEST_CHECK(!result.polish->kept);
    DOCTEST_CHECK(result.polish->steps == PolishSteps - 4);
    DOCTEST_CHECK(result.changed_outside_label == 0);
}

DOCTEST_TEST_CASE("held-out views show enough, are not redrawn, and lie farthest from those that are") {
    const auto views = test::ball_views(8, 16);
    const std::vector<double> covered{0.2, 0.2, 0.2, 0.2, 0.001, 0.2, 0.2, 0.2};
    const auto held = edit::views_to_hold_out(views, covered, {0, 1}, 2);
    DOCTEST_REQUIRE(held.size() == 2);
    for (const auto v : held) DOCTEST_CHECK((v >= 2 && v != 4));
    DOCTEST_CHECK(edit::views_to_hold_out(views, covered, {0, 1, 2, 3, 5, 6, 7}, 2).empty());
    DOCTEST_CHECK(edit::views_to_hold_out(views, covered, {0, 1, 2, 3, 5, 6}, 2).size() == 1);
}

}  // namespace polish_test
