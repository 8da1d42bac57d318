// Promises of the edit loop: nothing outside the label changes, the same seed gives the same bytes, a stop
// keeps the last state, hostile guidance does no harm.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/placement/voxel_region.h"
#include "tests/unit/edit/edit_scenes.h"

namespace session_test {

namespace {

using namespace gse;

edit::CheckedRequest short_request() {
    auto request = test::asked("ball", "a blue ball", "blue");
    request.iterations = 40;
    request.densify_from = 10;
    request.densify_every = 10;
    request.densify_percent = 0.1;
    request.snapshot_every = 10;
    request.seed = 5;
    return request;
}

struct Run {
    unsigned threads = 1;
    edit::SnapshotCallback snapshot{};
    JobControl job{};
    double snapshot_seconds = 0;
};

edit::EditResult run(const test::BallScene& scene, const edit::CheckedRequest& request,
                     edit::Guidance& guidance, const Run& how = {}) {
    ThreadPool pool(how.threads);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto plan = test::ball_plan(scene, *rasterizer);
    edit::EditTools tools{*rasterizer, &guidance, how.snapshot, how.job};
    tools.snapshot_seconds = how.snapshot_seconds;
    return edit::run_edit(scene.set, plan, request, tools);
}

/// Mean base colour of the rows with a bit.
Vec3 mean_colour(const GaussianSet& set, const std::vector<std::uint8_t>& bits) {
    Vec3 sum;
    double count = 0;
    const std::size_t stride = set.sh().size() / std::max<std::size_t>(set.size(), 1);
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (bits[row] == 0) continue;
        for (int c = 0; c < 3; ++c)
            sum[c] += colour_from_sh(set.sh()[row * stride + static_cast<std::size_t>(c)]);
        count += 1;
    }
    return sum / std::max(count, 1.0);
}

}  // namespace

DOCTEST_TEST_CASE("labelled rows follow the guidance, all others keep every bit, rows keep their order") {
    for (const int degree : {0, 3}) {
        const auto scene = test::ball_scene(120, degree);
        auto guidance = test::towards({0.1, 0.1, 0.9});
        auto request = short_request();
        const auto result = run(scene, request, guidance);
        DOCTEST_CHECK(result.changed_outside_label == 0);
        DOCTEST_CHECK(result.nonfinite == 0);
        DOCTEST_CHECK(result.history.size() == 40);
        DOCTEST_CHECK(result.cloned + result.split > 0);
        DOCTEST_CHECK(result.set.size() == result.label.size());
        DOCTEST_CHECK(result.set.size() == result.generation.size());
        const Vec3 before = mean_colour(scene.set, scene.first),
                   after = mean_colour(result.set, result.label);
        DOCTEST_CHECK(after.z > before.z + 0.1);
        DOCTEST_CHECK(after.x < before.x - 0.1);
        std::int64_t last = -1;
        for (std::size_t row = 0; row < scene.set.size(); ++row) {
            const std::int64_t now = result.base_to_new[row];
            DOCTEST_CHECK((now < 0 || now > last));
            if (now < 0) {
                DOCTEST_CHECK(scene.first[row] != 0);  // only labelled rows may go
                continue;
            }
            last = now;
            DOCTEST_CHECK(result.label[static_cast<std::size_t>(now)] == scene.first[row]);
            if (scene.first[row] != 0) continue;
            DOCTEST_CHECK(
                test::same_bytes(scene.set.position().subspan(row * 3, 3),
                                 result.set.position().subspan(static_cast<std::size_t>(now) * 3, 3)));
            DOCTEST_CHECK(result.generation[static_cast<std::size_t>(now)] == 0);
        }
        for (std::size_t row = static_cast<std::size_t>(last) + 1; row < result.set.size(); ++row) {
            DOCTEST_CHECK(result.label[row] == 1);  // new rows come last
            DOCTEST_CHECK(result.generation[row] > 0);
        }
    }
}

DOCTEST_TEST_CASE("one and two threads give the same bytes, another seed gives others") {
    const auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    auto request = short_request();
    const auto one = run(scene, request, guidance, {1});
    const auto two = run(scene, request, guidance, {2});
    DOCTEST_CHECK(test::same_bytes(one.set, two.set));
    DOCTEST_CHECK(one.label == two.label);
    request.seed = 6;
    DOCTEST_CHECK_FALSE(test::same_bytes(one.set, run(scene, request, guidance).set));
}

DOCTEST_TEST_CASE("a stop in the middle returns the last state, equal to a shorter history") {
    const auto scene = test::ball_scene();
    std::stop_source stop;
    int calls = 0;
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        if (++calls == 25) stop.request_stop();
        return test::towards({0.1, 0.1, 0.9}).evaluate(input);
    });
    GaussianSet snapshot;
    Run how;
    how.snapshot = [&](const edit::EditSnapshot& taken) {
        DOCTEST_CHECK(taken.iteration % 10 == 0);
        DOCTEST_CHECK(taken.base_to_new().size() == scene.set.size());
        snapshot = taken.materialise();
    };
    how.job.stop = stop.get_token();
    const auto result = run(scene, short_request(), guidance, how);
    DOCTEST_CHECK(result.stopped);
    DOCTEST_CHECK(result.iterations == 25);
    DOCTEST_CHECK(result.changed_outside_label == 0);
    DOCTEST_CHECK(result.nonfinite == 0);
    DOCTEST_REQUIRE(snapshot.size() > 0);
    DOCTEST_CHECK_FALSE(test::same_bytes(snapshot, scene.set));
}

DOCTEST_TEST_CASE("snapshots by time become rare where they take long") {
    const auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    const auto taken = [&](std::chrono::milliseconds cost) {
        int count = 0;
        Run how;
        how.snapshot_seconds = 1e-9;
        how.snapshot = [&](const edit::EditSnapshot&) {
            std::this_thread::sleep_for(cost);
            ++count;
        };
        const auto result = run(scene, short_request(), guidance, how);
        DOCTEST_REQUIRE(result.iterations == short_request().iterations);
        return count;
    };
    const int often = taken(std::chrono::milliseconds(0)), rare = taken(std::chrono::milliseconds(300));
    DOCTEST_CHECK(often > 1);
    DOCTEST_CHECK(rare >= 1);
    DOCTEST_CHECK(rare < often);
}

DOCTEST_TEST_CASE("snapshots are the states of the run and stay as they were") {
    const auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    std::vector<edit::EditSnapshot> snapshots;
    Run how;
    how.snapshot = [&](const edit::EditSnapshot& snapshot) { snapshots.push_back(snapshot); };
    const auto result = run(scene, short_request(), guidance, how);
    DOCTEST_REQUIRE(snapshots.size() == 4);
    DOCTEST_CHECK(test::same_bytes(snapshots.back().materialise(), result.set));
    DOCTEST_CHECK_FALSE(test::same_bytes(snapshots[0].materialise(), snapshots[1].materialise()));
}

DOCTEST_TEST_CASE("guidance is shown the unedited view beside the changing one") {
    const auto scene = test::ball_scene();
    std::map<std::size_t, Image> first;
    bool changed = false;
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        DOCTEST_REQUIRE(input.original != nullptr);
        const auto known = first.emplace(input.view_index, *input.original).first;
        DOCTEST_CHECK(known->second.data == input.original->data);
        Image shown = *input.original;
        for (auto& value : shown.data) value = std::clamp(value, 0.0f, 1.0f);
        if (input.iteration == 0) DOCTEST_CHECK(shown.data == input.rendered.data);
        changed = changed || shown.data != input.rendered.data;
        return test::towards({0.1, 0.1, 0.9}).evaluate(input);
    });
    run(scene, short_request(), guidance);
    DOCTEST_CHECK(changed);
}

DOCTEST_TEST_CASE("guidance that is not finite is left out and counted") {
    const auto scene = test::ball_scene();
    int calls = 0;
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        auto output = test::towards({0.1, 0.1, 0.9}).evaluate(input);
        ++calls;
        if (calls % 4 == 0) output.gradient.data[7] = std::numeric_limits<float>::quiet_NaN();
        if (calls % 4 == 1) output.gradient.data[11] = -std::numeric_limits<float>::infinity();
        return output;
    });
    log::set_level(log::Level::Off);
    const auto result = run(scene, short_request(), guidance);
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(result.skipped_steps == 20);
    DOCTEST_CHECK(result.nonfinite == 0);
    DOCTEST_CHECK(mean_colour(result.set, result.label).z > mean_colour(scene.set, scene.first).z + 0.05);
}

DOCTEST_TEST_CASE("one enormous first gradient does not silence the guidance") {
    const auto scene = test::ball_scene();
    int calls = 0;
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        auto output = test::towards({0.1, 0.1, 0.9}).evaluate(input);
        if (++calls == 1)
            for (auto& value : output.gradient.data) value *= 1e25f;
        return output;
    });
    const auto result = run(scene, short_request(), guidance);
    DOCTEST_CHECK(result.nonfinite == 0);
    DOCTEST_CHECK(mean_colour(result.set, result.label).z > mean_colour(scene.set, scene.first).z + 0.05);
}

DOCTEST_TEST_CASE("no label, and a label nobody sees, are refused in one sentence") {
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    auto guidance = test::towards({0, 0, 1});
    auto plan = test::ball_plan(scene, *rasterizer, 3, 16);
    plan.label.assign(plan.label.size(), 0);
    DOCTEST_CHECK_THROWS_AS(
        edit::run_edit(scene.set, plan, short_request(), {*rasterizer, &guidance, {}, {}}), Error);
    GaussianData data = scene.set.to_data();
    for (std::size_t row = 0; row < data.size(); ++row) data.opacity_logit[row] = -20;
    plan.label = scene.first;
    DOCTEST_CHECK_THROWS_AS(
        edit::run_edit(GaussianSet(std::move(data)), plan, short_request(), {*rasterizer, &guidance, {}, {}}),
        Error);
}

DOCTEST_TEST_CASE("seeds are new rows of a later generation, the scene itself stays") {
    const auto scene = test::ball_scene();
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    auto plan = test::ball_plan(scene, *rasterizer);
    plan.label.assign(plan.label.size(), 0);
    edit::VoxelRegion region;
    region.side = 0.2;
    region.centres = {{-0.55, -0.6, 0}, {-0.55, -0.8, 0}};
    plan.seeds = edit::seed_splats(region, 60, 0, 1);
    auto guidance = test::towards({0.1, 0.1, 0.9});
    const auto result = edit::run_edit(scene.set, plan, short_request(), {*rasterizer, &guidance, {}, {}});
    DOCTEST_CHECK(result.set.size() > scene.set.size());
    for (std::size_t row = 0; row < scene.set.size(); ++row)
        DOCTEST_CHECK(result.base_to_new[row] == static_cast<std::int64_t>(row));
    DOCTEST_CHECK(test::same_bytes(scene.set.sh(), result.set.sh().first(scene.set.sh().size())));
    for (std::size_t row = scene.set.size(); row < result.set.size(); ++row) {
        DOCTEST_CHECK(result.label[row] == 1);
        DOCTEST_CHECK(result.generation[row] >= 1);
    }
}

DOCTEST_TEST_CASE("growth is capped") {
    const auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    auto request = short_request();
    request.densify_percent = 1;
    request.max_growth = 1.2;
    request.iterations = 60;
    const auto result = run(scene, request, guidance);
    const auto labelled = static_cast<double>(std::count(result.label.begin(), result.label.end(), 1));
    DOCTEST_CHECK(labelled <= 1.2 * 150);
}

DOCTEST_TEST_CASE("a full colour coupling shifts all rows alike, none lets each go its own way") {
    auto scene = test::ball_scene();
    GaussianData data = scene.set.to_data();
    for (std::size_t i = 0; i < data.sh.size(); ++i)
        data.sh[i] = static_cast<float>(sh_from_colour(i % 3 == 0 ? 0.8 : 0.3));
    scene.set = GaussianSet(
        std::move(data));  // of one colour, so that a common change has nothing to tell rows apart by
    test::FunctionGuidance guidance(
        [](const edit::GuidanceInput& input) {  // upper half blue, lower half yellow
            edit::GuidanceOutput output;
            output.gradient = Image(input.rendered.width, input.rendered.height, 3);
            for (int y = 0; y < input.rendered.height; ++y)
                for (int x = 0; x < input.rendered.width; ++x)
                    for (int c = 0; c < 3; ++c) {
                        const bool upper = y < input.rendered.height / 2;
                        output.gradient.at(x, y, c) =
                            input.rendered.at(x, y, c) - ((c == 2) == upper ? 0.9f : 0.1f);
                    }
            return output;
        });
    auto request = short_request();
    request.densify_every = 0;
    const auto contrast = [&](double coupling) {
        request.colour_coupling = coupling;
        const auto result = run(scene, request, guidance);
        double upper = 0, lower = 0;
        for (std::size_t row = 0; row < 60; ++row) {  // rows go from y = +0.4 (below, as -y is up) to -0.4
            lower += result.set.sh()[row * 3 + 2] - scene.set.sh()[row * 3 + 2];
            upper += result.set.sh()[(90 + row) * 3 + 2] - scene.set.sh()[(90 + row) * 3 + 2];
        }
        return (upper - lower) / 60;
    };
    constexpr double SameForAll = 1e-4;  // float rounding of forty steps
    DOCTEST_CHECK(std::abs(contrast(1)) < SameForAll);
    DOCTEST_CHECK(contrast(0) > 0.3);
}

DOCTEST_TEST_CASE("a label corrected in the middle of a run is taken over") {
    const auto scene = test::ball_scene();
    auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = test::ball_plan(scene, *rasterizer);
    auto request = short_request();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    // The upper half of the red ball leaves the label, ten rows of the green one join it.
    std::vector<std::uint8_t> corrected = scene.first;
    std::size_t joined = 0;
    for (std::size_t row = 0; row < corrected.size(); ++row) {
        if (corrected[row] != 0 && scene.set.position()[row * 3 + 1] < 0) corrected[row] = 0;
        else if (corrected[row] == 0 && joined < 10) corrected[row] = 1, ++joined;
    }
    int asked = 0;
    edit::EditTools tools{*rasterizer, &guidance, {}, {}};
    tools.new_label = [&]() -> std::optional<std::vector<std::uint8_t>> {
        return ++asked == request.iterations / 2 ? std::optional(corrected) : std::nullopt;
    };
    const auto result = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_CHECK(result.label_changes == 1);
    // Against the corrected label: what left it is as it was.
    DOCTEST_CHECK(result.changed_outside_label == 0);
    std::size_t changed = 0;
    for (std::size_t row = 0; row < corrected.size(); ++row) {
        const auto now = result.base_to_new[row];
        if (now < 0) continue;
        const bool same =
            result.set.sh()[static_cast<std::size_t>(now) * 3 + 2] == scene.set.sh()[row * 3 + 2];
        DOCTEST_CHECK((corrected[row] != 0 || same));
        changed += same ? 0 : 1;
    }
    DOCTEST_CHECK(changed > 50);
}

DOCTEST_TEST_CASE("what was driven to black comes back") {
    const auto scene = test::ball_scene();
    auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = test::ball_plan(scene, *rasterizer, 6, 24);
    auto request = test::asked("ball", "a grey ball", "grey");
    request.iterations = 160;
    request.densify_every = 0;
    test::FunctionGuidance guidance([&](const edit::GuidanceInput& input) {
        edit::GuidanceOutput output;
        output.gradient = Image(input.rendered.width, input.rendered.height, 3);
        const float goal = input.iteration < 60 ? -1.0f : 0.4f;  // black and darker, then grey
        for (std::size_t i = 0; i < output.gradient.data.size(); ++i)
            output.gradient.data[i] = input.rendered.data[i] - goal;
        return output;
    });
    const auto result = edit::run_edit(scene.set, plan, request, {*rasterizer, &guidance, {}, {}});
    double sum = 0, count = 0;
    for (const auto& view : plan.views) {
        raster::ForwardOutput output;
        rasterizer->forward(result.set.spans(), view.camera, {}, output);
        const Mask mask = test::true_mask(scene.set, scene.first, view.camera, *rasterizer);
        for (std::size_t i = 0; i < mask.data.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                if (mask.data[i] != 0) {
                    sum += std::abs(output.colour.data[i * 3 + c] - 0.4);
                    ++count;
                }
    }
    DOCTEST_CHECK(count > 0);
    DOCTEST_CHECK(sum / count < 0.12);  // left behind in the dark it would be 0.4
}

DOCTEST_TEST_CASE("a run goes on from a snapshot: its rows, its iteration, and nothing outside the label") {
    const auto scene = test::ball_scene();
    auto guidance = test::towards({0.1, 0.1, 0.9});
    auto request = short_request();
    std::vector<edit::EditSnapshot> snapshots;
    run(scene, request, guidance,
        {1, [&](edit::EditSnapshot snapshot) { snapshots.push_back(std::move(snapshot)); }});
    DOCTEST_REQUIRE(snapshots.size() == 4);
    const auto& start = snapshots[1];
    DOCTEST_REQUIRE(start.iteration == 20);
    DOCTEST_CHECK(start.size() > scene.set.size());  // rows were born before it
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto plan = test::ball_plan(scene, *rasterizer);
    const auto go_on = [&](const edit::EditSnapshot& from, edit::Guidance& pull) {
        edit::EditTools tools{*rasterizer, &pull, {}, {}};
        tools.start = &from;
        return edit::run_edit(scene.set, plan, request, tools);
    };
    request.iterations = 20;  // nothing is left: what comes out is what went in, with the rows in their order
    const auto same = go_on(start, guidance);
    DOCTEST_CHECK(same.iterations == 20);
    DOCTEST_CHECK(same.history.empty());
    DOCTEST_CHECK(test::same_bytes(same.set, start.materialise()));
    DOCTEST_CHECK(same.base_to_new == start.base_to_new());
    DOCTEST_CHECK(same.generation == start.generation());
    // Settings as they are now: another colour pulls from there on.
    request.iterations = 60;
    auto other = test::towards({0.1, 0.9, 0.1});
    const auto result = go_on(start, other);
    DOCTEST_CHECK(result.iterations == 60);
    DOCTEST_CHECK(result.history.front().iteration == 20);
    DOCTEST_CHECK(result.history.size() == 40);
    DOCTEST_CHECK(result.changed_outside_label == 0);
    const auto label_of = [&](const edit::EditResult& of) { return mean_colour(of.set, of.label); };
    DOCTEST_CHECK(label_of(same).z > mean_colour(scene.set, scene.first).z + 0.03);
    DOCTEST_CHECK(label_of(result).y > label_of(same).y + 0.1);
    // A smaller label: what the snapshot changed outside of it is the base's again.
    auto half = plan;
    std::size_t dropped = 0;
    for (std::size_t row = 0; row < half.label.size(); row += 2)
        dropped += half.label[row], half.label[row] = 0;
    DOCTEST_REQUIRE(dropped > 0);
    edit::EditTools tools{*rasterizer, &other, {}, {}};
    tools.start = &start;
    const auto smaller = edit::run_edit(scene.set, half, request, tools);
    DOCTEST_CHECK(smaller.changed_outside_label == 0);
}

}  // namespace session_test
