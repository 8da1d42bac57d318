// Estimates add up what was measured, for what is still to be done.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "app/session/state/estimate.h"
#include "engine/edit/search/place_drawing.h"
#include "engine/pipeline/models/probe.h"

namespace estimate_test {

namespace {

using namespace gse;

app::CostProfile measured() {
    app::CostProfile measured;
    measured.load = 3;
    measured.question = 0.1;
    measured.rounds = 2;
    measured.idea = 4;
    measured.guidance = 0.05;
    measured.raster = 0.01;
    measured.rows = 1000;
    measured.finish = 1;
    measured.tune_step = 0.3;
    return measured;
}

/// With what a redrawn view takes.
app::CostProfile redrawing() {
    auto known = measured();
    known.redraw = 0.02;
    known.redraw_view = 0.05;
    return known;
}

app::PlannedWork located() {
    app::PlannedWork work;
    work.loaded = work.located = true;
    work.rows = 1000;
    return work;
}

double seconds(const app::CostProfile& measured, const edit::EditRequest& request,
               const app::PlannedWork& work) {
    return app::estimated_cost(measured, request, work).seconds;
}

}  // namespace

DOCTEST_TEST_CASE("an estimate is the sum of what is to be done") {
    edit::EditRequest request;
    request.method = "sds";
    request.iterations = 100;
    request.views = 10;
    request.dynamic_mask = false;
    auto work = located();
    DOCTEST_CHECK(seconds(measured(), request, work) == doctest::Approx(4 + 100 * 0.06 + 1));
    work.shows_idea = false;
    DOCTEST_CHECK(seconds(measured(), request, work) == doctest::Approx(100 * 0.06 + 1));
    work.first_iteration = 60;  // a branch
    DOCTEST_CHECK(seconds(measured(), request, work) == doctest::Approx(40 * 0.06 + 1));
    work = located();
    work.rows = 3000;  // the model's part of a step stays
    DOCTEST_CHECK(seconds(measured(), request, work) == doctest::Approx(4 + 100 * 0.08 + 1));
    work = located();
    work.loaded = work.located = false;
    work.tune_steps = 10;
    // Ten views twice.
    DOCTEST_CHECK(seconds(measured(), request, work) ==
                  doctest::Approx(3 + 3 + 20 * 0.1 + 4 + 100 * 0.06 + 1));
    request.dynamic_mask = true;  // half of the steps, each view once an eighth
    auto known = measured();
    known.follow = 0.5;
    DOCTEST_CHECK(seconds(known, request, located()) == doctest::Approx(4 + 100 * 0.06 + 20 * 0.1 + 1));
    known.refresh = 0.2;
    DOCTEST_CHECK(seconds(known, request, located()) == doctest::Approx(4 + 100 * 0.06 + 20 * 0.2 + 1));
}

DOCTEST_TEST_CASE("an estimate of redrawn views: what a view takes, and each of its steps, once per round") {
    edit::EditRequest request;
    request.method = "views";
    request.rounds = 2;
    request.edited_views = 8;
    request.view_steps = 6;
    request.fit_steps = 40;
    auto known = redrawing();
    known.redraw_tflop = 0.003;
    known.redraw_view_tflop = 0.002;
    known.begin = 0.5;
    auto work = located();
    work.shows_idea = false;
    const double fit = 80 * 0.01, rest = 0.5 + 1;
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(16 * (0.05 + 6 * 0.02) + fit + rest));
    DOCTEST_CHECK(app::estimated_cost(known, request, work).tflop ==
                  doctest::Approx(16 * (0.002 + 6 * 0.003)));
    known.supports_appearance_editing = 1;
    request.restyle_steps = 2;
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(16 * (0.05 + 2 * 0.02) + fit + rest));
    known.supports_appearance_editing = 0;
    work.first_iteration = 10;  // a branch goes on with what was redrawn
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(8 * (0.05 + 6 * 0.02) + 70 * 0.01 + rest));
    work = located();  // the pictures before the edit, from a pass of the search
    known.idea = -1;
    known.pass = 0.01;
    known.pass_tflop = 0.001;
    constexpr double passes = 4 * 6 * 2;  // eight steps from three quarters on, both halves
    DOCTEST_CHECK(seconds(known, request, work) ==
                  doctest::Approx(passes * 0.01 + 16 * (0.05 + 6 * 0.02) + fit + rest));
    DOCTEST_CHECK(app::estimated_cost(known, request, work).tflop ==
                  doctest::Approx(passes * 0.001 + 16 * (0.002 + 6 * 0.003)));
    known.redraw = -1;
    DOCTEST_CHECK(seconds(known, request, work) < 0);
}

DOCTEST_TEST_CASE("an estimate tells rounds for which a tiny autoencoder does from the last one") {
    edit::EditRequest request;
    request.method = "views";
    request.rounds = 3;
    request.edited_views = 8;
    request.view_steps = 4;
    request.fit_steps = 10;
    auto known = measured();
    known.redraw = 1;
    known.redraw_tflop = 0.8;
    known.redraw_view = 20;
    known.redraw_view_tflop = 5;
    known.redraw_early = 2;
    known.redraw_early_tflop = 0.3;
    auto work = located();
    work.shows_idea = false;
    const double rest = 30 * 0.01 + 1;
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(8 * (20 + 2 * 2 + 3 * 4 * 1) + rest));
    DOCTEST_CHECK(app::estimated_cost(known, request, work).tflop ==
                  doctest::Approx(8 * (5 + 2 * 0.3 + 3 * 4 * 0.8)));
    work.first_iteration = 15;  // the third round is left
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(8 * (20 + 4) + 15 * 0.01 + 1));
}

DOCTEST_TEST_CASE("an estimate counts the view that is drawn first for the colour of a new thing") {
    edit::EditRequest request;
    request.prompt = "a bear with white wings on the grass";
    request.source = "bear";
    request.target = "wings";
    auto known = redrawing();
    auto work = located();
    work.mode = edit::EditMode::Add;
    const auto plan = edit::round_plan(request, work.mode);
    const double told = seconds(known, request, work);
    request.prompt = "a bear with wings on the grass";
    const double key = 0.05 + plan.guided_steps_of(0) * 0.02;  // those that are not guided count half
    DOCTEST_CHECK(plan.guided_steps_of(0) < plan.steps_of(0));
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(told + key));
    work.first_iteration = 1;  // it is drawn already
    request.prompt = "a bear with white wings on the grass";
    const double branch = seconds(known, request, work);
    request.prompt = "a bear with wings on the grass";
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(branch));
}

DOCTEST_TEST_CASE("an estimate counts no such view where a new thing comes in its usual colour") {
    edit::EditRequest request;
    request.prompt = "a green frog on the grass";
    request.source = "bear";
    request.target = "frog";
    const auto known = redrawing();
    auto work = located();
    work.mode = edit::EditMode::Replace;
    const double told = seconds(known, request, work);
    request.prompt = "a frog on the grass";
    DOCTEST_CHECK(seconds(known, request, work) > told);
    work.words = {"a", "frog", "green", "on", "the", "grass"};
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(told));
    work.words = {"a", "frog", "red", "on", "the", "grass"};  // the model cannot say it
    DOCTEST_CHECK(seconds(known, request, work) > told);
}

DOCTEST_TEST_CASE("an estimate counts the views that are drawn to see where something goes") {
    edit::EditRequest request;
    request.prompt = "a bear wearing a red hat on the grass";
    request.source = "bear";
    request.target = "hat";
    auto known = redrawing();
    auto work = located();
    work.mode = edit::EditMode::Add;
    const double loop = seconds(known, request, work);
    work.located = false;
    const double words = known.rounds * request.views * known.question;
    // The hat is looked for, too.
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(loop + 2 * words));
    known.draws_place = 1;
    const double steps = edit::guided_steps_of_place(request);
    DOCTEST_CHECK(steps < request.place_steps);  // those that are not guided count half
    DOCTEST_CHECK(seconds(known, request, work) ==
                  doctest::Approx(loop + words + request.place_views * (0.05 + steps * 0.02)));
    known.place_step = 0.03;  // seen once
    DOCTEST_CHECK(seconds(known, request, work) ==
                  doctest::Approx(loop + words + request.place_views * steps * 0.03));
    // They show its colour, too: no view is drawn for that.
    request.prompt = "a bear wearing a hat on the grass";
    DOCTEST_CHECK(seconds(known, request, work) ==
                  doctest::Approx(loop + words + request.place_views * steps * 0.03));
    request.prompt = "a red hat beside a bear on the grass";  // said, not drawn
    const double beside = seconds(known, request, work);
    work.located = true;
    DOCTEST_CHECK(beside == doctest::Approx(seconds(known, request, work) + 2 * words));
    work.located = false;
    work.mode = edit::EditMode::Replace;  // no such pictures
    const double other = seconds(known, request, work);
    known.draws_place = 0;
    DOCTEST_CHECK(seconds(known, request, work) == doctest::Approx(other));
}

DOCTEST_TEST_CASE(
    "an estimate of memory: the process without the model, the model, the work, and what follows from the "
    "scene") {
    app::PlannedMemory memory;
    memory.process = 100;
    memory.weights = 50;
    memory.scene = 10;
    memory.labelled_share = 0.5;
    memory.snapshots = 120;
    // The set, two put together; of half of it what steps need; snapshots.
    const double scene = 3 * 10 + 6 * 10 * 0.5 + 120;
    DOCTEST_CHECK(app::estimated_memory_mb({}, memory) == doctest::Approx(100 + 300 + 50 + scene));
    app::CostProfile known;
    known.load_mb = 400;
    app::measure_memory(known, memory, 500, 1000);
    app::measure_memory(known, memory, 500, 600);  // a smaller job changes nothing
    DOCTEST_CHECK(known.work_mb == doctest::Approx(500 - scene));
    DOCTEST_CHECK(app::estimated_memory_mb(known, memory) == doctest::Approx(1000));
    memory.loaded = true;
    memory.before_load = 100;
    memory.process = 700;
    DOCTEST_CHECK(app::estimated_memory_mb(known, memory) == doctest::Approx(1000));
    memory.process = 1200;  // it holds more already
    DOCTEST_CHECK(app::estimated_memory_mb(known, memory) == doctest::Approx(1200));
}

DOCTEST_TEST_CASE("what was never measured is not guessed") {
    edit::EditRequest request;
    request.method = "sds";
    DOCTEST_CHECK(seconds({}, request, {}) < 0);
    auto known = measured();
    known.guidance = -1;
    DOCTEST_CHECK(seconds(known, request, located()) < 0);
    known = measured();
    known.load = -1;
    DOCTEST_CHECK(seconds(known, request, located()) > 0);  // it is loaded already
    auto work = located();
    work.loaded = false;
    DOCTEST_CHECK(seconds(known, request, work) < 0);
}

DOCTEST_TEST_CASE(
    "a large scene is thinned out for its time: shares and labels stay, a small one stays whole") {
    GaussianData data;
    data.resize(1000);
    for (std::size_t row = 0; row < data.size(); ++row) data.position[row * 3] = static_cast<float>(row);
    const GaussianSet scene(std::move(data));
    edit::EditPlan plan;
    plan.label.assign(1000, 0);
    for (std::size_t row = 900; row < 1000; ++row) plan.label[row] = 1;
    const auto whole = pipeline::probe_scene(scene, plan, 1000);
    DOCTEST_CHECK(whole.set.shares_all_with(scene));
    const auto part = pipeline::probe_scene(scene, plan, 300);
    DOCTEST_CHECK(part.set.size() == 225 + 25);  // every fourth of each kind
    DOCTEST_REQUIRE(part.plan.label.size() == part.set.size());
    for (std::size_t row = 0; row < part.set.size(); ++row)
        DOCTEST_CHECK((part.plan.label[row] != 0) == (part.set.position()[row * 3] >= 900));
    for (std::size_t row = 0; row + 1 < 1000; ++row) plan.label[row] = 0;
    const auto lonely = pipeline::probe_scene(scene, plan, 10);
    DOCTEST_CHECK(std::count(lonely.plan.label.begin(), lonely.plan.label.end(), 1) == 1);
}

}  // namespace estimate_test
