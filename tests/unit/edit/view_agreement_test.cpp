// Redrawn views that show a change or none, agree on it or not.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/target_views/view_agreement.h"
#include "tests/unit/edit/view_oracle.h"

namespace view_agreement_test {

using namespace gse;

namespace {

/// Renders of the red ball from all sides, with the depth of the surface.
std::vector<edit::EditView> rendered_views(const test::BallScene& scene, raster::Rasterizer& rasterizer,
                                           int count = 8) {
    std::vector<edit::EditView> views;
    raster::ForwardOutput output;
    for (const auto& view : test::ball_views(count, 48)) {
        rasterizer.forward(scene.set.spans(), view.camera, {}, output);
        edit::EditView shown{output.colour, output.colour, output.depth, {}, view};
        for (std::size_t i = 0; i < shown.depth.data.size(); ++i) {
            const float alpha = output.alpha.data[i];
            shown.depth.data[i] = alpha > 0.5f ? output.depth.data[i] / alpha : 0.0f;
        }
        shown.mask = test::true_mask(scene.set, scene.first, view.camera, rasterizer);
        views.push_back(std::move(shown));
    }
    return views;
}

/// The ball in a flat grey of its own in every view.
std::vector<Image> painted(const std::vector<edit::EditView>& views, const std::vector<float>& greys) {
    std::vector<Image> pictures;
    for (std::size_t v = 0; v < views.size(); ++v) {
        pictures.push_back(views[v].rendered);
        for (std::size_t i = 0; i < pictures[v].data.size(); ++i)
            if (views[v].mask.data[i / 3] != 0) pictures[v].data[i] = greys[v];
    }
    return pictures;
}

}  // namespace

DOCTEST_TEST_CASE("views that show one colour agree, and one that differs from all others is noticed") {
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto views = rendered_views(test::ball_scene(), *rasterizer);
    const auto same = edit::view_agreement(views, painted(views, std::vector<float>(views.size(), 0.5f)));
    DOCTEST_CHECK(same.disagreement == doctest::Approx(0).epsilon(1e-6));
    DOCTEST_CHECK(same.unchanged == 0);
    DOCTEST_CHECK(edit::warnings_of(same, false).empty());

    auto greys = std::vector<float>(views.size(), 0.5f);
    greys[3] = 0.9f;
    const auto odd = edit::view_agreement(views, painted(views, greys));
    DOCTEST_CHECK(odd.disagreement > 0);
    DOCTEST_CHECK(odd.disagreement < 0.4 / 2);  // most points are as in most views
    const auto each = edit::view_disagreements(views, painted(views, greys));
    DOCTEST_CHECK(each[3] == doctest::Approx(0.4));
    for (std::size_t v = 0; v < views.size(); ++v)
        if (v != 3) DOCTEST_CHECK(each[v] == doctest::Approx(0).epsilon(1e-6));

    for (std::size_t v = 0; v < views.size(); ++v) greys[v] = v % 2 == 0 ? 0.1f : 0.9f;
    const auto split = edit::view_agreement(views, painted(views, greys));
    DOCTEST_CHECK(split.disagreement > odd.disagreement);
    DOCTEST_CHECK(edit::warnings_of(split, false).size() == 1);
    DOCTEST_CHECK(edit::warnings_of(split, true).empty());  // the depths are of another shape
    DOCTEST_CHECK(split.scalars().at("disagreement") == split.disagreement);
}

DOCTEST_TEST_CASE("what two views show says nothing about agreement, and no view says nothing at all") {
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto two = rendered_views(test::ball_scene(), *rasterizer, 2);
    DOCTEST_CHECK(edit::view_agreement(two, painted(two, {0.1f, 0.9f})).disagreement == 0);
    DOCTEST_CHECK(edit::warnings_of(edit::view_agreement({}, {}), false).empty());
}

DOCTEST_TEST_CASE("a change at the mask's rim is told from one in its middle") {
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto views = rendered_views(test::ball_scene(), *rasterizer, 3);
    auto middle = views;
    std::vector<Image> pictures;
    for (auto& view : middle) {
        pictures.push_back(view.rendered);
        for (int y = 20; y < 28; ++y)
            for (int x = 20; x < 28; ++x)
                pictures.back().data[static_cast<std::size_t>(y * 48 + x) * 3] += 0.5f;
        view.mask = Mask(48, 48);
        for (auto& bit : view.mask.data) bit = 1;
        for (int x = 0; x < 48; ++x) view.mask.data[static_cast<std::size_t>(x)] = 0;  // the rim is far above
    }
    DOCTEST_CHECK(edit::view_agreement(middle, pictures).at_rim == 0);
    for (auto& view : middle)
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 48; ++x)
                view.mask.data[static_cast<std::size_t>(y * 48 + x)] = 0;  // now it cuts into the change
    const auto cut = edit::view_agreement(middle, pictures);
    DOCTEST_CHECK(cut.at_rim > 0);
    DOCTEST_CHECK(cut.at_rim < 1);
    edit::ViewAgreement cut_off;
    cut_off.at_rim = 0.5;
    DOCTEST_CHECK(edit::warnings_of(cut_off, false).size() == 1);
    DOCTEST_CHECK(edit::warnings_of(cut_off, true).empty());  // it has room of its own
    for (auto& view : middle)  // a thin thing is all rim: what turns it red evenly is not cut off
        for (int y = 23; y < 48; ++y)
            for (int x = 0; x < 48; ++x) view.mask.data[static_cast<std::size_t>(y * 48 + x)] = 0;
    const auto thin = edit::view_agreement(middle, pictures);
    DOCTEST_CHECK(thin.at_rim > 0.5);
    DOCTEST_CHECK(thin.rim_share > 0.5);
    DOCTEST_CHECK(edit::warnings_of(thin, false).empty());
}

DOCTEST_TEST_CASE("an artist is told when the model left the views as they were") {
    test::Redrawing run;
    const auto request = test::view_request(1, 40);
    std::vector<edit::ViewTargets> sheets;
    run.tools.targets = [&](const edit::ViewTargets& sheet) { sheets.push_back(sheet); };
    run.edited(request);
    DOCTEST_REQUIRE(!sheets.empty());
    DOCTEST_CHECK(sheets.back().warnings.empty());  // the ball turns blue

    sheets.clear();
    test::OracleViews idle(run.scene.set, *run.rasterizer);
    run.tools.views = &idle;
    run.edited(request);
    DOCTEST_REQUIRE(!sheets.empty());
    DOCTEST_REQUIRE(sheets.front().warnings.size() == 1);
    DOCTEST_CHECK(sheets.front().warnings.front().find("100 % of the redrawn views hardly differ") == 0);

    struct Unfinished final : edit::MultiViewEditor {  // a pattern comes over them
        explicit Unfinished(edit::MultiViewEditor& idle) : views(idle) {}
        edit::EditedViews edit(const std::vector<edit::EditView>& seen, const edit::EditViewsRequest& input,
                               const JobControl& job) override {
            auto targets = views.edit(seen, input, job);
            targets.unfinished = true;
            return targets;
        }
        edit::MultiViewEditor& views;
    } unfinished(idle);
    sheets.clear();
    run.tools.views = &unfinished;
    run.edited(request);
    DOCTEST_REQUIRE(!sheets.empty());
    DOCTEST_CHECK(sheets.front().warnings.empty());
}

DOCTEST_TEST_CASE(
    "colour that is lost between the redrawn views and the scene is noticed, where there is colour to lose") {
    Image red(4, 4, 3);
    for (std::size_t i = 0; i < red.data.size(); i += 3) red.data[i] = 0.8f;
    Mask all(4, 4), none(4, 4);
    std::fill(all.data.begin(), all.data.end(), std::uint8_t{1});
    DOCTEST_CHECK(edit::mean_chroma(red, all) == doctest::Approx(0.8));
    DOCTEST_CHECK(edit::mean_chroma(red, none) == 0);
    const double kept = edit::kept_chroma({0.8, 0.6, 0.4}, {0.3, 0.3});
    DOCTEST_CHECK(kept == doctest::Approx(0.5));  // of the median
    DOCTEST_CHECK(!edit::warning_of_chroma(kept).empty());
    DOCTEST_CHECK(edit::warning_of_chroma(0.9).empty());
    const double grey = edit::kept_chroma({0.02, 0.01}, {0.0});
    DOCTEST_CHECK(grey < 0);
    DOCTEST_CHECK(edit::warning_of_chroma(grey).empty());
}

DOCTEST_TEST_CASE(
    "a view that differs from all others counts less in the fit, where three or more show a point") {
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto views = rendered_views(test::ball_scene(), *rasterizer);
    auto greys = std::vector<float>(views.size(), 0.5f);
    greys[3] = 0.95f;
    const auto trust = edit::trust_weights(views, painted(views, greys));
    DOCTEST_REQUIRE(trust.size() == views.size());
    const auto least = [&](std::size_t v) {
        return *std::min_element(trust[v].data.begin(), trust[v].data.end());
    };
    DOCTEST_CHECK(least(3) == doctest::Approx(0.1));  // 0.45 away
    DOCTEST_CHECK(least(7) == doctest::Approx(1.0));
    for (std::size_t v = 0; v < views.size(); ++v)
        for (std::size_t i = 0; i < trust[v].data.size(); ++i)
            if (views[v].mask.data[i] == 0) DOCTEST_REQUIRE(trust[v].data[i] == 1.0f);
    const std::vector<edit::EditView> two(views.begin(), views.begin() + 2);
    for (const auto& weights : edit::trust_weights(two, painted(two, {0.1f, 0.9f})))
        DOCTEST_CHECK(
            std::all_of(weights.data.begin(), weights.data.end(), [](float w) { return w == 1.0f; }));
}

}  // namespace view_agreement_test
