// View guidance without networks: which views are redrawn, noise on the surface, what is blended, and the
// loop that fits to it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/edit/optimise/surface_noise.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/target_views/view_round.h"
#include "tests/unit/edit/edit_scenes.h"
#include "tests/unit/edit/view_oracle.h"

namespace view_round_test {

namespace {

using namespace gse;
using test::Redrawing;
using test::view_request;

double correlation(const Image& a, const Image& b) {
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        ab += static_cast<double>(a.data[i]) * b.data[i];
        aa += static_cast<double>(a.data[i]) * a.data[i];
        bb += static_cast<double>(b.data[i]) * b.data[i];
    }
    return ab / std::sqrt(aa * bb);
}

}  // namespace

DOCTEST_TEST_CASE("view guidance: the rows are fitted to what was redrawn, all others keep every bit") {
    Redrawing run;
    std::vector<int> snapshots;
    run.tools.snapshot = [&](edit::EditSnapshot snapshot) { snapshots.push_back(snapshot.iteration); };
    auto request = view_request(2, 40);
    request.snapshot_every = 20;
    const auto result = run.edited(request);
    DOCTEST_CHECK(result.iterations == 80);
    DOCTEST_CHECK(snapshots == std::vector{20, 40, 60, 80});
    DOCTEST_CHECK(result.changed_outside_label == 0);
    constexpr double most_left = 0.35;  // of the error: noise-free targets, but only eighty steps
    DOCTEST_CHECK(run.error_of(result.set) < most_left * run.error_of(run.scene.set));
    const auto& inputs = run.oracle.inputs;
    DOCTEST_REQUIRE(inputs.size() == 2);
    DOCTEST_CHECK(inputs[1].round == 1);
    DOCTEST_CHECK(inputs[0].seed != inputs[1].seed);
    DOCTEST_CHECK(result.history[0].guidance.count("views") == 1);
    DOCTEST_CHECK(result.history[0].guidance.count("broken") == 0);
    std::size_t drawn_from = 0;
    for (std::size_t view = 0; view < run.plan.views.size(); ++view)
        drawn_from += std::any_of(result.history.begin(), result.history.end(),
                                  [&](const auto& line) { return line.view == view; });
    DOCTEST_CHECK(drawn_from == 4);
    Redrawing again;
    DOCTEST_CHECK(test::same_bytes(again.edited(request).set.sh(), result.set.sh()));
}

DOCTEST_TEST_CASE("view guidance: a stop before the next round keeps what was reached") {
    Redrawing run;
    std::stop_source stop;
    run.tools.job.stop = stop.get_token();
    run.tools.iteration = [&](const edit::IterationRecord& record) {
        if (record.iteration == 9) stop.request_stop();  // the next round would begin now
    };
    const auto result = run.edited(view_request(3, 10));
    DOCTEST_CHECK(result.stopped);
    DOCTEST_CHECK(result.iterations == 10);
    DOCTEST_CHECK(run.oracle.inputs.size() == 1);
    DOCTEST_CHECK(run.error_of(result.set) < run.error_of(run.scene.set));
}

DOCTEST_TEST_CASE("view guidance: a round that fails keeps what the rounds before have reached") {
    Redrawing run;
    run.oracle.fails_in = 1;
    const auto result = run.edited(view_request(3, 10));
    DOCTEST_REQUIRE(result.failure.has_value());
    DOCTEST_CHECK(result.failure->code() == ErrorCode::Model);
    DOCTEST_CHECK(!result.stopped);
    DOCTEST_CHECK(result.iterations == 10);
    DOCTEST_CHECK(run.error_of(result.set) < run.error_of(run.scene.set));
    Redrawing nothing_yet;
    nothing_yet.oracle.fails_in = 0;
    DOCTEST_CHECK_THROWS_AS(nothing_yet.edited(view_request(3, 10)), Error);
}

DOCTEST_TEST_CASE("view guidance: a label corrected in the middle is fitted to what was redrawn already") {
    Redrawing run;
    std::vector<std::uint8_t> half = run.scene.first;
    for (std::size_t row = 0; row < half.size(); row += 2) half[row] = 0;
    int asked = 0;
    run.tools.new_label = [&]() -> std::optional<std::vector<std::uint8_t>> {
        return asked++ == 5 ? std::optional(half) : std::nullopt;
    };
    const auto result = run.edited(view_request(1, 20));
    DOCTEST_CHECK(result.label_changes == 1);
    DOCTEST_CHECK(result.iterations == 20);
    DOCTEST_CHECK(run.oracle.inputs.size() == 1);
    DOCTEST_CHECK(result.changed_outside_label == 0);
}

DOCTEST_TEST_CASE("redrawn views lie far apart and show what changes") {
    const auto views = test::ball_views(12, 16);
    std::vector<double> covered(12, 0.2);
    covered[5] = 0.5;
    covered[6] = 0.001;  // hardly seen
    const auto chosen = edit::views_to_redraw(views, covered, 4);
    DOCTEST_REQUIRE(chosen.size() == 4);
    DOCTEST_CHECK(std::is_sorted(chosen.begin(), chosen.end()));
    DOCTEST_CHECK(std::find(chosen.begin(), chosen.end(), 5) != chosen.end());
    DOCTEST_CHECK(std::find(chosen.begin(), chosen.end(), 6) == chosen.end());
    const double step = length(views[0].camera.centre() - views[1].camera.centre());
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j)
            DOCTEST_CHECK(length(views[chosen[i]].camera.centre() - views[chosen[j]].camera.centre()) >
                          1.5 * step);
    DOCTEST_CHECK(edit::views_to_redraw(views, covered, 50).size() == 11);
    DOCTEST_CHECK(edit::views_to_redraw(views, std::vector<double>(12, 0.0), 4).empty());
    // All are small.
    DOCTEST_CHECK(edit::views_to_redraw(views, std::vector<double>(12, 0.001), 4).size() == 4);
}

DOCTEST_TEST_CASE(
    "what is blended stays the original outside the mask, bit by bit, and goes over inside it") {
    Image original(16, 16, 3, 0.1f), edited(16, 16, 3, 0.9f);
    Mask mask(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 4; x < 16; ++x) mask.at(x, y) = 1;
    const Image result = edit::blend_inside(edited, original, mask, 2);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            if (x < 4) DOCTEST_CHECK(result.at(x, y, 1) == 0.1f);
            if (x >= 6) DOCTEST_CHECK(result.at(x, y, 1) == doctest::Approx(0.9));
        }
    DOCTEST_CHECK(result.at(4, 8, 0) > 0.1f);
    DOCTEST_CHECK(result.at(4, 8, 0) < result.at(5, 8, 0));
    DOCTEST_CHECK(result.at(5, 8, 0) < result.at(6, 8, 0));
    DOCTEST_CHECK(edit::blend_inside(edited, original, mask, 0).at(4, 8, 0) == doctest::Approx(0.9));
}

DOCTEST_TEST_CASE(
    "surface noise: unit variance, no blotches, the same place gets the same noise in every view") {
    // A wall across the whole picture; the second camera is moved by a whole number of cells.
    constexpr int side = 96, cells = 16;
    const double wall = 3;
    Camera camera = Camera::look_at({0, 0, wall}, {0, 0, 0}, {0, -1, 0}, 0.9, side, side);
    const Image depth(side, side, 1, static_cast<float>(wall));
    const double cell = wall / camera.fx * side / cells;
    Camera moved = Camera::look_at({2 * cell, 0, wall}, {2 * cell, 0, 0}, {0, -1, 0}, 0.9, side, side);
    const Image noise = edit::surface_noise(depth, camera, cells, 4, cell / 2, 7, 0);
    const Image shifted = edit::surface_noise(depth, moved, cells, 4, cell / 2, 7, 1);
    double squares = 0, neighbours = 0, pairs = 0;
    for (const float value : noise.data) squares += static_cast<double>(value) * value;
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x + 1 < cells; ++x)
            for (int c = 0; c < 4; ++c, ++pairs)
                neighbours += static_cast<double>(noise.at(x, y, c)) * noise.at(x + 1, y, c);
    // 1,024 samples: three standard errors of a variance are 0.13.
    constexpr double variance_tolerance = 0.15;
    DOCTEST_CHECK(std::abs(squares / static_cast<double>(noise.data.size()) - 1) < variance_tolerance);
    DOCTEST_CHECK(std::abs(neighbours / pairs) < 0.15);
    // Cells to the side: which way the picture moves.
    const double shift = camera.to_camera({2 * cell, 0, 0}).x / cell;
    const int by = static_cast<int>(std::lround(shift));
    Image here(cells - 2, cells, 4), there(cells - 2, cells, 4);
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells - 2; ++x)
            for (int c = 0; c < 4; ++c) {
                here.at(x, y, c) = noise.at(by > 0 ? x + 2 : x, y, c);
                there.at(x, y, c) = shifted.at(by > 0 ? x : x + 2, y, c);
            }
    DOCTEST_CHECK(correlation(here, there) > 0.9);
    DOCTEST_CHECK(std::abs(correlation(noise, edit::surface_noise(depth, camera, cells, 4, cell / 2, 8, 0))) <
                  0.15);
    DOCTEST_CHECK(edit::surface_noise(depth, camera, cells, 4, cell / 2, 7, 5).data == noise.data);
    // Where nothing is, every view has noise of its own.
    const Image nothing(side, side, 1);
    const Image empty = edit::surface_noise(nothing, camera, cells, 4, cell / 2, 7, 0);
    DOCTEST_CHECK(
        std::abs(correlation(empty, edit::surface_noise(nothing, camera, cells, 4, cell / 2, 7, 1))) < 0.15);
}

DOCTEST_TEST_CASE("views that hardly changed are redrawn once more from further off, and only once") {
    Redrawing run;
    auto request = view_request(2, 10);
    const double asked = request.view_strength;
    run.oracle.least_strength = asked + 0.05;
    const auto result = run.edited(request);
    const auto& inputs = run.oracle.inputs;
    DOCTEST_REQUIRE(inputs.size() == 3);
    DOCTEST_CHECK(inputs[0].strength == doctest::Approx(asked));
    DOCTEST_CHECK(inputs[1].strength == doctest::Approx(asked + 0.1));
    DOCTEST_CHECK(inputs[1].seed == inputs[0].seed);
    DOCTEST_CHECK(inputs[2].round == 1);
    DOCTEST_CHECK(inputs[2].strength > edit::round_plan(request, run.plan.mode).strength_of(1));
    DOCTEST_CHECK(result.redrawn_views == 12);
    DOCTEST_CHECK(run.error_of(result.set) < run.error_of(run.scene.set));

    Redrawing deaf;  // the model does not know the word
    deaf.oracle.least_strength = 2;
    std::vector<std::string> warnings;
    deaf.tools.targets = [&](const edit::ViewTargets& sheet) { warnings = sheet.warnings; };
    deaf.edited(view_request(2, 10));
    DOCTEST_CHECK(deaf.oracle.inputs.size() == 3);
    DOCTEST_CHECK(warnings.size() == 1);
}

DOCTEST_TEST_CASE("the fit to views that agree keeps their colour") {
    Redrawing run;
    const auto result = run.edited(view_request(1, 40));
    DOCTEST_CHECK(result.kept_chroma > 0.7);
    DOCTEST_CHECK(result.kept_chroma < 1.1);
}

DOCTEST_TEST_CASE("quality scales views and steps of a round, whatever they are set to") {
    edit::EditRequest request;
    request.prompt = "a blue ball";
    request.source = "ball";
    for (const auto mode : {edit::EditMode::Modify, edit::EditMode::Replace, edit::EditMode::Add}) {
        request.quality = "normal";
        const auto normal = edit::round_plan(request, mode);
        request.quality = "draft";
        const auto draft = edit::round_plan(request, mode);
        request.quality = "fine";
        const auto fine = edit::round_plan(request, mode);
        DOCTEST_CHECK(2 * draft.views == normal.views);
        DOCTEST_CHECK(fine.views == 2 * normal.views);
        DOCTEST_CHECK(draft.view_steps < normal.view_steps);
        DOCTEST_CHECK(fine.view_steps > normal.view_steps);
        DOCTEST_CHECK(draft.rounds == fine.rounds);
    }
    request.edited_views = request.view_steps = 1;
    request.quality = "draft";
    DOCTEST_CHECK(edit::round_plan(request, edit::EditMode::Modify).views == 1);
    DOCTEST_CHECK(edit::round_plan(request, edit::EditMode::Modify).view_steps == 1);
    request.quality = "best";
    DOCTEST_CHECK_THROWS_AS(edit::check(request).plain(), Error);
}

}  // namespace view_round_test
