// Hostile scenes, guidance and requests: the loop must end, count what it left out, and never write a
// non-finite value.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>
#include <new>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "tests/unit/edit/edit_scenes.h"

namespace hostile_edits_test {

namespace {

using namespace gse;

constexpr float Nan = std::numeric_limits<float>::quiet_NaN();
constexpr float Infinity = std::numeric_limits<float>::infinity();

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

edit::CheckedRequest hostile_request() {
    auto request = test::asked("ball", "a blue ball", "blue");
    request.iterations = 30;
    request.densify_from = 5;
    request.densify_every = 5;
    request.densify_percent = 0.3;
    request.geometry_share = 1;
    request.colour_coupling = 0.5;
    return request;
}

edit::EditResult run(const test::BallScene& scene, const edit::CheckedRequest& request,
                     edit::Guidance& guidance) {
    const Quiet quiet;
    ThreadPool pool(2);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto plan = test::ball_plan(test::ball_scene(), *rasterizer);
    auto own = plan;
    own.label = scene.first;
    return edit::run_edit(scene.set, own, request, {*rasterizer, &guidance, {}, {}});
}

/// The ball scene with `change` applied to its arrays.
template <class F> test::BallScene changed(F&& change) {
    auto scene = test::ball_scene();
    GaussianData data = scene.set.to_data();
    change(data);
    scene.set = GaussianSet(std::move(data));
    return scene;
}

void check_sane(const edit::EditResult& result) {
    DOCTEST_CHECK(result.changed_outside_label == 0);
    DOCTEST_CHECK(result.nonfinite == 0);
    DOCTEST_CHECK(result.set.size() == result.label.size());
}

}  // namespace

DOCTEST_TEST_CASE("guidance of every size and kind") {
    const auto scene = test::ball_scene();
    for (const float size : {0.0f, 1e-38f, 1e-20f, 1e20f, 1e37f}) {
        test::FunctionGuidance guidance([size](const edit::GuidanceInput& input) {
            edit::GuidanceOutput output;
            output.gradient = Image(input.rendered.width, input.rendered.height, 3);
            Random random(input.seed);
            for (auto& value : output.gradient.data) value = size * static_cast<float>(random.uniform(-1, 1));
            return output;
        });
        const auto result = run(scene, hostile_request(), guidance);
        check_sane(result);
        DOCTEST_CHECK(result.skipped_steps == 0);
    }
}

DOCTEST_TEST_CASE("guidance that is finite in no step ends the edit with a reason, soon") {
    for (const float value : {Nan, Infinity, -Infinity}) {
        int calls = 0;
        test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
            ++calls;
            return edit::GuidanceOutput{Image(input.rendered.width, input.rendered.height, 3, value),
                                        {{"loss", Nan}}};
        });
        std::string message;
        try {
            run(test::ball_scene(), hostile_request(), guidance);
        } catch (const Error& error) {
            DOCTEST_CHECK(error.code() == ErrorCode::Model);
            message = error.what();
        }
        DOCTEST_CHECK(message.find("not finite") != std::string::npos);
        DOCTEST_CHECK(calls == 10);
    }
}

DOCTEST_TEST_CASE(
    "guidance that stops being finite leaves the last good state, one such step leaves no trace") {
    const auto scene = test::ball_scene();
    auto request = hostile_request();
    request.densify_every = 0;
    constexpr int good = 12;
    auto pull = test::towards({0.1, 0.1, 0.9});
    const auto run_with_bad = [&](int from, int to) {
        test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
            auto output = pull.evaluate(input);
            output.scalars["loss"] = 1;
            if (input.iteration < from || input.iteration >= to) return output;
            output.gradient.data[5] = Nan;
            output.scalars["loss"] = Infinity;
            return output;
        });
        return run(scene, request, guidance);
    };
    const auto result = run_with_bad(good, 1000);
    check_sane(result);
    DOCTEST_REQUIRE(result.failure.has_value());
    DOCTEST_CHECK(result.failure->message().find("not finite") != std::string::npos);
    DOCTEST_CHECK(result.skipped_steps == 10);
    DOCTEST_CHECK(result.iterations == good + 10);
    DOCTEST_CHECK(result.history.size() == good + 10);
    for (const auto& record : result.history) {
        DOCTEST_CHECK(record.skipped == (record.iteration >= good));
        DOCTEST_CHECK(record.guidance.count("loss") == (record.skipped ? 0 : 1));
    }
    request.iterations = good;  // rates follow the share of the iterations that is done
    request.rate_position_end = request.rate_position;
    const auto fixed_rates = run_with_bad(1000, 1000);
    request.iterations = good + 10;
    DOCTEST_CHECK(test::same_bytes(run_with_bad(good, 1000).set, fixed_rates.set));
    const auto last = run_with_bad(good + 9, good + 10);
    request.iterations = good + 9;
    DOCTEST_CHECK_FALSE(last.failure.has_value());
    DOCTEST_CHECK(last.skipped_steps == 1);
    DOCTEST_CHECK(test::same_bytes(last.set, run_with_bad(1000, 1000).set));
}

DOCTEST_TEST_CASE("a few bad steps in a row, and many that are rare, do not end an edit") {
    auto pull = test::towards({0.1, 0.1, 0.9});
    auto request = hostile_request();
    request.iterations = 140;
    const auto skipped = [&](const std::function<bool(int)>& bad) {
        test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
            auto output = pull.evaluate(input);
            if (bad(input.iteration)) output.gradient.data[5] = Nan;
            return output;
        });
        const auto result = run(test::ball_scene(), request, guidance);
        check_sane(result);
        DOCTEST_CHECK_FALSE(result.failure.has_value());
        DOCTEST_CHECK(result.iterations == request.iterations);
        return result.skipped_steps;
    };
    DOCTEST_CHECK(skipped([](int step) { return step >= 20 && step < 29; }) == 9);
    DOCTEST_CHECK(skipped([](int step) { return step % 2 == 0; }) == 70);
    // Under a tenth of all by then.
    DOCTEST_CHECK(skipped([](int step) { return step >= 120 && step < 132; }) == 12);
}

DOCTEST_TEST_CASE("steps that are left out are not rest") {
    const Quiet quiet;
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = test::ball_plan(scene, *rasterizer, 1, 24);  // one view, drawn in every step
    auto request = hostile_request();
    request.densify_every = 0;
    request.iterations = 60;
    request.early_stop = true;
    request.early_stop_change = 0.006;  // the picture moves by more than 0.01 in each of the first steps
    auto pull = test::towards({0.1, 0.1, 0.9});
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        auto output = pull.evaluate(input);
        if (input.iteration % 12 > 2) output.gradient.data[5] = Nan;  // three good ones, nine bad ones
        return output;
    });
    const auto result = edit::run_edit(scene.set, plan, request, {*rasterizer, &guidance, {}, {}});
    DOCTEST_CHECK_FALSE(result.converged);
    DOCTEST_CHECK(result.skipped_steps == 45);
}

DOCTEST_TEST_CASE("huge learning rates stay within the guards") {
    auto request = hostile_request();
    request.rate_position = request.rate_position_end = 1;
    request.rate_colour = request.rate_sh = request.rate_opacity = request.rate_scale =
        request.rate_rotation = 10;
    request.min_opacity = 0;  // nothing is pruned away
    auto guidance = test::towards({0.1, 0.1, 0.9});
    const auto result = run(test::ball_scene(), request, guidance);
    check_sane(result);
    for (std::size_t row = 0; row < result.set.size(); ++row) {
        if (result.label[row] == 0) continue;
        DOCTEST_CHECK(std::abs(result.set.opacity_logit()[row]) <= 12.0f);
        for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
            DOCTEST_CHECK(std::exp(result.set.log_scale()[i]) < 0.51 * 3.5);
    }
}

DOCTEST_TEST_CASE("labelled rows that are broken at load do not spread") {
    struct Case {
        const char* name;
        std::function<void(GaussianData&)> change;
    };
    const std::vector<Case> cases{
        {"nan position", [](GaussianData& d) { d.position[3] = Nan; }},
        {"nan colour", [](GaussianData& d) { d.sh[4] = Nan; }},
        {"infinite scale", [](GaussianData& d) { d.log_scale[0] = Infinity; }},
        {"flat scale", [](GaussianData& d) { d.log_scale[0] = -Infinity; }},
        {"zero quaternion", [](GaussianData& d) { std::fill_n(d.rotation.begin(), 40, 0.0f); }},
        {"opaque and empty",
         [](GaussianData& d) { d.opacity_logit[0] = Infinity, d.opacity_logit[1] = -Infinity; }},
        {"giant", [](GaussianData& d) { std::fill_n(d.log_scale.begin(), 3, 5.0f); }},
        {"needles",
         [](GaussianData& d) {
             for (std::size_t i = 0; i < 90; i += 3) d.log_scale[i] = 0, d.log_scale[i + 1] = -9;
         }},
        {"coincident",
         [](GaussianData& d) {
             for (std::size_t i = 3; i < 300; ++i) d.position[i] = d.position[i % 3];
         }},
    };
    auto guidance = test::towards({0.1, 0.1, 0.9});
    for (const auto& hostile : cases) {
        DOCTEST_INFO(std::string(hostile.name));
        const auto scene = changed(hostile.change);
        const auto result = run(scene, hostile_request(), guidance);
        DOCTEST_CHECK(result.changed_outside_label == 0);
        std::size_t broken = 0;  // broken rows may stay as they came, but must not become more
        for (const float value : result.set.sh()) broken += std::isfinite(value) ? 0 : 1;
        for (const float value : result.set.position()) broken += std::isfinite(value) ? 0 : 1;
        for (const float value : result.set.rotation()) broken += std::isfinite(value) ? 0 : 1;
        DOCTEST_CHECK(broken <= 1);
        DOCTEST_CHECK(result.nonfinite == 0);  // they no longer count as labelled
    }
}

DOCTEST_TEST_CASE("rows that cannot be drawn come back bit for bit and spoil no loss") {
    const auto scene = changed([](GaussianData& d) {
        d.sh[3 * 0] = 1e30f;      // labelled
        d.position[3 * 1] = Nan;  // labelled
        d.sh[3 * 200] = -1e30f;   // not labelled
        d.position[3 * 201] = 1e30f;
        d.opacity_logit[202] = Nan;
    });
    auto guidance = test::towards({0.1, 0.1, 0.9});
    const auto result = run(scene, hostile_request(), guidance);
    check_sane(result);
    DOCTEST_CHECK(result.unusable_before == 5);
    DOCTEST_CHECK(result.unusable == 5);
    for (const std::size_t row : {0, 1, 200, 201, 202}) {
        const auto now = result.base_to_new[row];
        DOCTEST_REQUIRE(now >= 0);
        const auto to = static_cast<std::size_t>(now);
        DOCTEST_CHECK(result.label[to] == 0);
        DOCTEST_CHECK(test::same_bytes(result.set.position().subspan(to * 3, 3),
                                       scene.set.position().subspan(row * 3, 3)));
        DOCTEST_CHECK(
            test::same_bytes(result.set.sh().subspan(to * 3, 3), scene.set.sh().subspan(row * 3, 3)));
    }
    for (const auto& record : result.history) {
        DOCTEST_CHECK(record.preservation < 10);
        DOCTEST_CHECK(record.preservation_norm < 10);
    }
}

DOCTEST_TEST_CASE("when the memory runs out, what was reached is kept") {
    for (const bool torn : {false, true}) {
        auto pull = test::towards({0.1, 0.1, 0.9});
        test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
            if (input.iteration == 12) {
                if (torn) throw std::bad_alloc();
                throw OutOfMemory("there is not enough memory: 3 GB more were needed");
            }
            return pull.evaluate(input);
        });
        const auto result = run(test::ball_scene(), hostile_request(), guidance);
        check_sane(result);
        DOCTEST_REQUIRE(result.shortage.has_value());
        DOCTEST_CHECK(result.shortage->message().find("memory") != std::string::npos);
        DOCTEST_CHECK(result.iterations == 12);
        DOCTEST_CHECK(!test::same_bytes(result.set, test::ball_scene().set));
    }
    test::FunctionGuidance never(
        [](const edit::GuidanceInput&) -> edit::GuidanceOutput { throw std::bad_alloc(); });
    DOCTEST_CHECK_THROWS_AS(run(test::ball_scene(), hostile_request(), never),
                            OutOfMemory);  // nothing was reached
}

DOCTEST_TEST_CASE("one labelled splat, no iterations, and a label that fades away completely") {
    auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    std::fill(scene.first.begin(), scene.first.end(), std::uint8_t{0});
    scene.first[75] = 1;
    check_sane(run(scene, hostile_request(), guidance));
    auto request = hostile_request();
    request.iterations = 0;
    const auto nothing = run(test::ball_scene(), request, guidance);
    DOCTEST_CHECK(test::same_bytes(nothing.set, test::ball_scene().set));
    request = hostile_request();
    request.min_opacity = 1;  // every labelled row counts as too faint
    const auto gone = run(test::ball_scene(), request, guidance);
    check_sane(gone);
    DOCTEST_CHECK(gone.set.size() == 150);
    DOCTEST_CHECK(gone.iterations == 5);
}

DOCTEST_TEST_CASE("far and tiny worlds") {
    for (const double scale : {1e-4, 1e4}) {
        auto scene = test::ball_scene();
        GaussianData data = scene.set.to_data();
        for (auto& value : data.position) value *= static_cast<float>(scale);
        for (auto& value : data.log_scale) value += static_cast<float>(std::log(scale));
        scene.set = GaussianSet(std::move(data));
        const auto rasterizer = raster::make_plain_rasterizer();
        auto plan = test::ball_plan(test::ball_scene(), *rasterizer, 3, 24);
        for (auto& view : plan.views) view.camera.translation = view.camera.translation * scale;
        plan.settings.near_plane = static_cast<float>(0.01 * scale);
        auto guidance = test::towards({0.1, 0.1, 0.9});
        check_sane(edit::run_edit(scene.set, plan, hostile_request(), {*rasterizer, &guidance, {}, {}}));
    }
}

}  // namespace hostile_edits_test
