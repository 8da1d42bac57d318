// Which views the loop draws, and what it compares to tell that an edit has come to rest.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/log.h"
#include "engine/edit/placement/voxel_region.h"
#include "tests/unit/edit/edit_scenes.h"

namespace session_views_test {

namespace {

using namespace gse;

constexpr std::size_t ViewsOfEach = 3;

/// The first views see the red ball alone, the others the green one alone.
edit::EditPlan separate_plan(const test::BallScene& scene, raster::Rasterizer& rasterizer) {
    constexpr double narrow = 0.2;  // radians: half a ball
    edit::EditPlan plan;
    plan.label = scene.first;
    for (const double x : {-0.55, 0.55})
        for (std::size_t i = 0; i < ViewsOfEach; ++i) {
            const double height = 0.3 * static_cast<double>(i) - 0.3;
            View view = test::ball_views(1, 24).front();
            view.camera = Camera::look_at({x, height, 3}, {x, 0, 0}, {0, -1, 0}, narrow, 24, 24);
            plan.views.push_back(view);
            plan.masks.push_back(test::true_mask(scene.set, scene.first, view.camera, rasterizer));
        }
    return plan;
}

edit::CheckedRequest plain_request(int iterations) {
    auto request = test::asked("ball", "a blue ball", "blue");
    request.iterations = iterations;
    request.densify_every = 0;
    request.dynamic_mask = false;
    return request;
}

/// Says `label` before iteration `at`.
std::function<std::optional<std::vector<std::uint8_t>>()> at_iteration(int at,
                                                                       std::vector<std::uint8_t> label) {
    return [at, label, asked = 0]() mutable -> std::optional<std::vector<std::uint8_t>> {
        return asked++ == at ? std::optional(label) : std::nullopt;
    };
}

/// Sees nothing anywhere.
class BlindAttention : public edit::AttentionSource {
public:
    int calls = 0;
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        ++calls;
        return {Image(query.image.width, query.image.height, 1)};
    }
    int image_size() const override { return 24; }
};

}  // namespace

DOCTEST_TEST_CASE("after a corrected label the loop draws the views that see it") {
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = separate_plan(scene, *rasterizer);
    std::vector<std::uint8_t> green = scene.first;
    for (auto& bit : green) bit = bit == 0 ? 1 : 0;
    auto guidance = test::towards({0.1, 0.1, 0.9});
    edit::EditTools tools{*rasterizer, &guidance, {}, {}};
    tools.new_label = at_iteration(12, green);
    const auto result = edit::run_edit(scene.set, plan, plain_request(24), tools);
    DOCTEST_CHECK(result.label_changes == 1);
    DOCTEST_REQUIRE(result.history.size() == 24);
    for (const auto& record : result.history)
        DOCTEST_CHECK((record.view < ViewsOfEach) == (record.iteration < 12));
    DOCTEST_CHECK(result.changed_outside_label == 0);
    std::size_t changed = 0;
    for (std::size_t row = 0; row < green.size(); ++row)
        changed += result.set.sh()[row * 3 + 2] != scene.set.sh()[row * 3 + 2];
    DOCTEST_CHECK(changed == static_cast<std::size_t>(std::count(green.begin(), green.end(), 1)));
}

DOCTEST_TEST_CASE("a corrected label that no view sees is not taken over") {
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    auto plan = separate_plan(scene, *rasterizer);
    plan.views.resize(ViewsOfEach);
    plan.masks.resize(ViewsOfEach);
    std::vector<std::uint8_t> green = scene.first;
    for (auto& bit : green) bit = bit == 0 ? 1 : 0;
    auto guidance = test::towards({0.1, 0.1, 0.9});
    edit::EditTools tools{*rasterizer, &guidance, {}, {}};
    const auto plain = edit::run_edit(scene.set, plan, plain_request(16), tools);
    tools.new_label = at_iteration(8, green);
    log::set_level(log::Level::Off);
    const auto result = edit::run_edit(scene.set, plan, plain_request(16), tools);
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(result.label_changes == 0);
    DOCTEST_CHECK(test::same_bytes(result.set, plain.set));
}

DOCTEST_TEST_CASE("after a corrected label an edit rests only when every view that sees it does") {
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = separate_plan(scene, *rasterizer);
    auto still = test::still();
    auto request = plain_request(60);
    request.early_stop = true;
    edit::EditTools tools{*rasterizer, &still, {}, {}};
    constexpr int at = 4;  // before the views of the red ball have been drawn twice
    tools.new_label = at_iteration(at, std::vector<std::uint8_t>(scene.first.size(), 1));
    const auto result = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_CHECK(result.converged);
    std::vector<int> drawn(plan.views.size(), 0);
    for (const auto& record : result.history)
        if (record.iteration >= at) ++drawn[record.view];
    for (const int times : drawn) DOCTEST_CHECK(times >= 2);
}

DOCTEST_TEST_CASE("looking again for what is new does not delay the rest") {
    const auto scene = test::ball_scene();
    const auto rasterizer = raster::make_plain_rasterizer();
    auto plan = test::ball_plan(scene, *rasterizer, 5, 24);
    plan.label.assign(plan.label.size(), 0);
    edit::VoxelRegion region;
    region.side = 0.3;
    region.centres = {{0, -0.6, 0}};
    plan.seeds = edit::seed_splats(region, 30, 0, 1, 0.5);
    auto request = plain_request(120);
    request.early_stop = true;
    request.early_stop_change = 0.004;
    constexpr int moves = 56;  // the first look is after iteration 60, while the pictures still settle
    test::FunctionGuidance guidance([](const edit::GuidanceInput& input) {
        return input.iteration < moves ? test::towards({0.1, 0.9, 0.1}).evaluate(input)
                                       : test::still().evaluate(input);
    });
    BlindAttention attention;
    edit::EditTools tools{*rasterizer, &guidance, {}, {}};
    tools.word = "ball";
    tools.attention = &attention;  // finds nothing, so that nothing is dropped
    const auto looked = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_CHECK(attention.calls == 10);  // after iterations 60 and 90, five views each
    request.prune_added = false;
    const auto plain = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_REQUIRE(plain.converged);
    DOCTEST_CHECK(plain.iterations > 90);
    DOCTEST_CHECK(looked.iterations == plain.iterations);
    DOCTEST_CHECK(test::same_bytes(looked.set, plain.set));
}

}  // namespace session_views_test
