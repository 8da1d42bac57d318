// Masks that follow the edit: refreshed when due, joined with the label, never running away; and the detector
// of rest.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/masks/dynamic_mask.h"
#include "engine/edit/optimise/convergence.h"
#include "engine/edit/placement/voxel_region.h"
#include "tests/unit/edit/edit_scenes.h"

namespace dynamic_mask_test {

namespace {

using namespace gse;

constexpr int Side = 64;

Mask disc(double x, double y, double radius) {
    Mask mask(Side, Side);
    for (int row = 0; row < Side; ++row)
        for (int column = 0; column < Side; ++column)
            mask.at(column, row) = std::hypot(column + 0.5 - x, row + 0.5 - y) < radius ? 1 : 0;
    return mask;
}

Image picture(const Mask& mask) {
    Image image(mask.width, mask.height, 1);
    std::copy(mask.data.begin(), mask.data.end(), image.data.begin());
    return image;
}

/// Attends where it is told.
class FixedAttention : public edit::AttentionSource {
public:
    Mask where{Side, Side};
    int calls = 0;
    std::string word;  // asked for last
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        ++calls;
        word = query.words.front();
        return {picture(where)};
    }
    int image_size() const override { return Side; }
};

struct Setup {
    edit::EditPlan plan;
    edit::CheckedRequest request = test::asked("ball", "a ball", "ball");
    FixedAttention attention;
    Image shown{Side, Side, 3, 0.5f};
    Setup() {
        plan.views = test::ball_views(2, Side);
        plan.masks = {disc(32, 32, 10), disc(32, 32, 10)};
        request.iterations = 100;
        request.dilate_px = 0;
    }
    edit::DynamicMasks masks() { return {plan, request, "ball", &attention, nullptr}; }
};

std::size_t different(const Mask& a, const Mask& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) count += a.data[i] != b.data[i] ? 1 : 0;
    return count;
}

}  // namespace

DOCTEST_TEST_CASE("masks are static first, then refreshed now and then; without attention never") {
    Setup setup;
    const auto masks = setup.masks();
    DOCTEST_CHECK_FALSE(masks.due(0, 0));
    DOCTEST_CHECK_FALSE(masks.due(0, 49));
    DOCTEST_CHECK(masks.due(0, 50));
    auto used = setup.masks();
    setup.attention.where = disc(32, 32, 10);
    used.refresh(0, 50, setup.shown, picture(disc(32, 32, 12)));
    DOCTEST_CHECK_FALSE(used.due(0, 55));
    DOCTEST_CHECK(used.due(0, 63));
    DOCTEST_CHECK(used.due(1, 55));  // every view has its own clock
    setup.request.dynamic_mask = false;
    DOCTEST_CHECK_FALSE(setup.masks().due(0, 99));
    setup.request.dynamic_mask = true;
    DOCTEST_CHECK_FALSE(edit::DynamicMasks(setup.plan, setup.request, "ball", nullptr, nullptr).due(0, 99));
}

DOCTEST_TEST_CASE("a mask follows what moved, in two steps, and only where the label is near") {
    Setup setup;
    auto masks = setup.masks();
    setup.attention.where = disc(38, 32, 10);
    const Image label = picture(disc(36, 32, 14));
    masks.refresh(0, 50, setup.shown, label);
    const std::size_t once = different(masks.mask(0), setup.attention.where);
    DOCTEST_CHECK(different(masks.mask(0), setup.plan.masks[0]) == 0);  // one half is inside the hysteresis
    masks.refresh(0, 70, setup.shown, label);
    DOCTEST_CHECK(different(masks.mask(0), setup.attention.where) < once);
    masks.refresh(0, 90, setup.shown, label);
    const auto near = different(masks.mask(0), setup.attention.where);
    DOCTEST_CHECK(near <= 8);  // the 64-cell grid and the reach of the label round a few pixels
    DOCTEST_CHECK(different(masks.mask(1), setup.plan.masks[1]) == 0);
    // Attention far from everything labelled counts for nothing.
    setup.attention.where = disc(8, 8, 6);
    const Mask before = masks.mask(0);
    masks.refresh(0, 99, setup.shown, picture(disc(45, 45, 5)));
    DOCTEST_CHECK(different(masks.mask(0), before) == 0);
    DOCTEST_CHECK(masks.kept() == 1);
}

DOCTEST_TEST_CASE("what replaces the word is looked for, as the sentence does not hold the word any more") {
    Setup setup;
    setup.attention.where = disc(32, 32, 10);
    setup.masks().refresh(0, 50, setup.shown, picture(disc(32, 32, 12)));
    DOCTEST_CHECK(setup.attention.word == "ball");
    setup.request = setup.request.reworded("a bear on the snow", "snow");
    edit::DynamicMasks(setup.plan, setup.request, "grass", &setup.attention, nullptr)
        .refresh(0, 50, setup.shown, picture(disc(32, 32, 12)));
    DOCTEST_CHECK(setup.attention.word == "snow");
    setup.request = setup.request.with_target("");
    DOCTEST_CHECK_FALSE(
        edit::DynamicMasks(setup.plan, setup.request, "grass", &setup.attention, nullptr).due(0, 99));
}

DOCTEST_TEST_CASE("a mask that would run away, or be empty, stays as it was") {
    Setup setup;
    auto masks = setup.masks();
    setup.attention.where = disc(32, 32, 31);
    masks.refresh(0, 50, setup.shown, picture(disc(32, 32, 31)));
    DOCTEST_CHECK(different(masks.mask(0), setup.plan.masks[0]) == 0);
    setup.attention.where = Mask(Side, Side);
    masks.refresh(0, 60, setup.shown, picture(disc(32, 32, 31)));
    DOCTEST_CHECK(different(masks.mask(0), setup.plan.masks[0]) == 0);
    DOCTEST_CHECK(masks.kept() == 2);
    DOCTEST_CHECK(masks.refreshed() == 0);
}

DOCTEST_TEST_CASE("rest is when no view changes, and not before all were seen twice") {
    edit::ConvergenceDetector rest(3, 0.01);
    rest.ignore(2);
    const Mask mask = disc(32, 32, 10);
    Image shown(Side, Side, 3, 0.5f);
    DOCTEST_CHECK_FALSE(rest.visit(0, shown, mask));
    DOCTEST_CHECK_FALSE(rest.visit(1, shown, mask));
    DOCTEST_CHECK_FALSE(rest.visit(0, shown, mask));
    DOCTEST_CHECK(rest.visit(1, shown, mask));
    for (auto& value : shown.data) value = 0.6f;
    DOCTEST_CHECK_FALSE(rest.visit(0, shown, mask));
}

DOCTEST_TEST_CASE("the loop refreshes masks and stops when it is at rest") {
    const auto scene = test::ball_scene();
    auto rasterizer = raster::make_plain_rasterizer();
    const auto plan = test::ball_plan(scene, *rasterizer, 4, 24);
    auto request = test::asked("ball", "a ball", "ball");
    request.iterations = 40;
    request.densify_every = 0;
    FixedAttention attention;
    attention.where = Mask(24, 24, 1);
    auto still = test::still();
    edit::EditTools tools{*rasterizer, &still, {}, {}};
    tools.attention = &attention;
    tools.word = "ball";
    const auto all = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_CHECK(all.iterations == 40);
    DOCTEST_CHECK(attention.calls >= 4);
    DOCTEST_CHECK_FALSE(all.converged);
    request.early_stop = true;
    const auto early = edit::run_edit(scene.set, plan, request, tools);
    DOCTEST_CHECK(early.converged);
    DOCTEST_CHECK(early.iterations < 40);
}

DOCTEST_TEST_CASE("new splats outside of where the new thing is seen go, unless nearly all would") {
    const auto scene = test::ball_scene();
    auto rasterizer = raster::make_plain_rasterizer();
    auto plan = test::ball_plan(scene, *rasterizer, 6, 24);
    plan.label.assign(plan.label.size(), 0);
    edit::VoxelRegion high, low;  // the scene's up is -y
    high.side = low.side = 0.2;
    high.centres = {{0, -0.75, 0}};
    low.centres = {{0, 0.75, 0}};
    plan.seeds = edit::seed_splats(high, 30, 0, 1, 0.5);
    const auto below = edit::seed_splats(low, 20, 0, 2, 0.5);
    for (std::size_t row = 0; row < below.size(); ++row) plan.seeds.append_row(below, row);
    auto request = test::asked("ball", "a ball wearing a hat", "hat");
    request.iterations = 8;
    request.densify_every = 0;
    request.dynamic_mask = false;
    FixedAttention attention;
    attention.where = Mask(24, 24);
    auto still = test::still();
    edit::EditTools tools{*rasterizer, &still, {}, {}};
    tools.attention = &attention;
    tools.word = "hat";
    const auto added = [&] {
        const auto result = edit::run_edit(scene.set, plan, request, tools);
        std::size_t above = 0, all = result.set.size() - scene.set.size();
        for (std::size_t row = scene.set.size(); row < result.set.size(); ++row)
            above += result.set.position()[row * 3 + 1] < 0 ? 1 : 0;
        return std::pair{above, all - above};
    };
    DOCTEST_CHECK(added() == std::pair<std::size_t, std::size_t>{30, 20});  // nothing seen: nothing dropped
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 24; ++x) attention.where.at(x, y) = 1;
    DOCTEST_CHECK(added() == std::pair<std::size_t, std::size_t>{30, 0});
    request.prune_added = false;
    DOCTEST_CHECK(added() == std::pair<std::size_t, std::size_t>{30, 20});
    request.prune_added = true;
    attention.where = Mask(24, 24);
    for (int x = 0; x < 24; ++x) attention.where.at(x, 0) = 1;  // far from all of them
    DOCTEST_CHECK(added() == std::pair<std::size_t, std::size_t>{30, 20});
}

}  // namespace dynamic_mask_test
