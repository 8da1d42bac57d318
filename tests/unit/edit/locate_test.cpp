// Words to labels with stand-ins for the networks: blurred true masks as attention.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/search/cached_attention.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/edit/search/make_plan.h"
#include "engine/language/words.h"
#include "tests/unit/edit/locate_scenes.h"

namespace locate_test {

using namespace locate_scenes;

namespace {

constexpr double LeastIou = 0.9;            // blurred attention, clicks and twelve views at 48 px
constexpr double LeastIouUnrefined = 0.65;  // a blurred map above one half covers less than the thing

}  // namespace

DOCTEST_TEST_CASE("an object word labels its splats, with every segmenter and without") {
    const Quiet quiet;
    const auto request = request_for("a blue ball", "blue");
    for (const bool segmented : {false, true}) {
        Fixture fixture;
        const auto segmenter = edit::make_default_segmenter();
        const auto found =
            edit::locate(fixture.input(request), fixture.tools(segmented ? segmenter.get() : nullptr));
        DOCTEST_CHECK(found.mode == edit::EditMode::Modify);
        DOCTEST_CHECK(found.word == "ball");
        DOCTEST_CHECK(found.failed_views == 0);
        DOCTEST_INFO("segmenter " << segmented << " iou " << iou(*found.label.bits, fixture.scene.first));
        DOCTEST_CHECK(iou(*found.label.bits, fixture.scene.first) >
                      (segmented && edit::grabcut_available() ? LeastIou : LeastIouUnrefined));
        DOCTEST_CHECK(found.seeds.size() == 0);
        int by_points = 0;
        for (const auto& view : found.views) {
            DOCTEST_CHECK(view.mask.count() > 0);
            DOCTEST_CHECK(view.captured > 0.4);
            by_points += view.branch == "points" ? 1 : 0;
            const auto inside = std::count_if(view.points.begin(), view.points.end(),
                                              [](const auto& p) { return p.positive; });
            DOCTEST_CHECK(inside >= 1);
            DOCTEST_CHECK(inside <= 5);
        }
        DOCTEST_CHECK((by_points > 6) == segmented);
        const auto plan = edit::make_plan(fixture.input(request), found, *fixture.rasterizer);
        DOCTEST_CHECK(plan.label == *found.label.bits);
        for (std::size_t v = 0; v < plan.masks.size(); ++v)
            DOCTEST_CHECK(plan.masks[v].count() >= found.views[v].mask.count());
    }
}

DOCTEST_TEST_CASE("the same seed asks and answers the same; views get seeds of their own") {
    const Quiet quiet;
    const auto request = request_for("a blue ball", "blue");
    Fixture one, two;
    const auto a = edit::locate(one.input(request), one.tools());
    const auto b = edit::locate(two.input(request), two.tools());
    DOCTEST_CHECK(*a.label.bits == *b.label.bits);
    DOCTEST_CHECK(*a.label.weight == *b.label.weight);
    DOCTEST_REQUIRE(one.attention.queries.size() == 12);
    for (std::size_t v = 0; v < 12; ++v) {
        DOCTEST_CHECK(one.attention.queries[v].seed == two.attention.queries[v].seed);
        DOCTEST_CHECK(one.attention.queries[v].prompt == "a blue ball");
        if (v > 0) DOCTEST_CHECK(one.attention.queries[v].seed != one.attention.queries[0].seed);
    }
}

DOCTEST_TEST_CASE(
    "views in which nothing is found do not vote; too many of them label nothing and show why") {
    const Quiet quiet;
    const auto request = request_for("a blue ball", "blue");
    Fixture some;
    some.attention.blind_views = 5;
    const auto found = edit::locate(some.input(request), some.tools());
    DOCTEST_CHECK(found.failed_views == 5);
    DOCTEST_CHECK(iou(*found.label.bits, some.scene.first) > 0.6);
    for (const auto& view : found.views)
        if (view.failed) DOCTEST_CHECK((view.branch == "none" && view.mask.count() == 0));
    Fixture most;
    most.attention.blind_views = 7;
    const auto lost = edit::locate(most.input(request), most.tools());
    DOCTEST_CHECK(lost.problem == edit::SearchProblem::FewViews);
    DOCTEST_CHECK(lost.message.find("5 of 12") != std::string::npos);
    DOCTEST_CHECK(lost.remedy.find("by hand") != std::string::npos);
    DOCTEST_CHECK(lost.remedy.find("--") == std::string::npos);  // the window says it too
    DOCTEST_CHECK(lost.failed_views == 7);
    DOCTEST_REQUIRE(lost.views.size() == 12);
    for (const auto& view : lost.views) {
        DOCTEST_CHECK(view.render.width == Side);
        DOCTEST_CHECK(view.failed == (view.step == edit::ViewStep::NoAttention));
    }
    DOCTEST_CHECK(std::count(lost.label.bits->begin(), lost.label.bits->end(), 1) == 0);
    DOCTEST_CHECK_THROWS_AS(edit::require_found(lost), Error);
}

DOCTEST_TEST_CASE("a view says in which step it failed") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.dbscan_min_samples = 1000;  // no pixel has so many neighbours
    const auto scattered = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(scattered.problem == edit::SearchProblem::FewViews);
    for (const auto& view : scattered.views) DOCTEST_CHECK(view.step == edit::ViewStep::TooLittle);
    DOCTEST_CHECK(scattered.remedy.find("lower the attention threshold") != std::string::npos);
    for (const auto step :
         {edit::ViewStep::NoAttention, edit::ViewStep::TooLittle, edit::ViewStep::Everything})
        DOCTEST_CHECK((!edit::step_text(step).empty() && !edit::step_remedy(step).empty()));
}

DOCTEST_TEST_CASE("a label made by hand is taken as it is, and nothing is looked for") {
    const Quiet quiet;
    Fixture fixture;
    const auto request = request_for("a blue ball", "blue");
    auto input = fixture.input(request);
    input.label = &fixture.scene.first;
    const auto found = edit::locate(input, fixture.tools());
    DOCTEST_CHECK(fixture.attention.queries.empty());
    DOCTEST_CHECK(found.problem == edit::SearchProblem::None);
    DOCTEST_CHECK(found.confidence.value < 0);
    DOCTEST_CHECK(*found.label.bits == fixture.scene.first);
    for (const auto& view : found.views) {
        DOCTEST_CHECK(view.branch == "label");
        DOCTEST_CHECK(view.mask.count() > 0);
    }
    // Something new is put beside what is labelled.
    const auto hat = request_for("a ball with a hat", "hat");
    auto beside = fixture.input(hat);
    beside.label = &fixture.scene.first;
    const auto added = edit::locate(beside, fixture.tools());
    DOCTEST_CHECK(*added.source_label.bits == fixture.scene.first);
    DOCTEST_CHECK(added.seeds.size() == static_cast<std::size_t>(hat.seed_splats));
    for (const auto& query : fixture.attention.queries) DOCTEST_CHECK(query.word == "hat");
}

DOCTEST_TEST_CASE("a rival word takes the pixels that attend more to it") {
    const Quiet quiet;
    Fixture fixture;
    auto request = request_for("a blue ball", "blue");
    request.competing_words = "grass, ball";
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(fixture.attention.queries.front().prompt == "a blue ball, grass");
    for (const auto& view : found.views)
        for (int y = Side / 2 + 1; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                if (view.mask.at(x, y) != 0) DOCTEST_CHECK(view.map.at(x, y, 0) == 1);
    DOCTEST_CHECK(iou(*found.label.bits, fixture.scene.first) < 0.7);  // the lower half was given away
}

DOCTEST_TEST_CASE("what another thing of the sentence attends to for sure is not taken by the mask") {
    const Quiet quiet;
    Fixture fixture;
    GreedySegmenter segmenter;
    // "grass" attends to the lower half, the ball's too.
    auto request = request_for("a blue ball on the grass", "blue");
    request.label_smoothness = 0;  // every splat for itself: the votes alone
    const auto found = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    DOCTEST_CHECK(std::count_if(found.views.begin(), found.views.end(),
                                [](const auto& view) { return view.branch == "points"; }) > 6);
    DOCTEST_CHECK(fixture.attention.queries.front().prompt == "a blue ball on the grass");
    const double competing = iou(*found.label.bits, fixture.scene.first);
    DOCTEST_CHECK(competing > LeastIouUnrefined);  // the ball is kept, its lower half too
    request.competing_words = "none";
    const auto alone = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    constexpr double least_gain = 0.05;  // the other ball's lower half, in the views whose mask takes it
    DOCTEST_CHECK(competing > iou(*alone.label.bits, fixture.scene.first) + least_gain);
}

DOCTEST_TEST_CASE(
    "a thing of the sentence that the model cannot read does not end the search; one that was asked for "
    "does") {
    const Quiet quiet;
    Fixture fixture;
    fixture.attention.most_words = 1;
    auto request = request_for("a blue ball on the grass", "blue");
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(iou(*found.label.bits, fixture.scene.first) > LeastIouUnrefined);
    request.competing_words = "grass";
    DOCTEST_CHECK_THROWS_AS(edit::locate(fixture.input(request), fixture.tools()), Error);
}

DOCTEST_TEST_CASE("what the attention covers belongs to the thing, even where the segmenter leaves it out") {
    const Quiet quiet;
    Fixture fixture;
    TopSegmenter segmenter;
    auto request = request_for("a blue ball", "blue");
    request.label_smoothness = 0;  // every splat for itself: the votes alone
    const auto found = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    DOCTEST_CHECK(std::count_if(found.views.begin(), found.views.end(),
                                [](const auto& view) { return view.branch == "points"; }) > 6);
    const double covered = iou(*found.label.bits, fixture.scene.first);
    DOCTEST_CHECK(covered > LeastIouUnrefined);
    request.label_threshold = 0.6;  // more than half a vote: the masks must agree
    const auto strict = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    constexpr double least_gain = 0.1;  // the part left out is a third of the ball
    DOCTEST_CHECK(covered > iou(*strict.label.bits, fixture.scene.first) + least_gain);
}

DOCTEST_TEST_CASE("a segmenter that is trusted trims the attention") {
    const Quiet quiet;
    Fixture fixture;
    TopSegmenter segmenter;
    auto request = request_for("a blue ball", "blue");
    request.label_smoothness = 0;
    const auto joined = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    segmenter.trusted_ = true;
    const auto trimmed = edit::locate(fixture.input(request), fixture.tools(&segmenter));
    const auto labelled = [](const auto& found) {
        return std::count(found.label.bits->begin(), found.label.bits->end(), 1);
    };
    DOCTEST_CHECK(labelled(trimmed) > 0);
    DOCTEST_CHECK(labelled(trimmed) <
                  0.9 * static_cast<double>(labelled(joined)));  // it leaves a third of the ball out
}

DOCTEST_TEST_CASE("a text segmenter that agrees with the attention is believed") {
    const Quiet quiet;
    Fixture fixture;
    RedDetector detector;
    const auto request = request_for("a blue ball", "blue");
    const auto found = edit::locate(fixture.input(request), fixture.tools(nullptr, &detector));
    for (const auto& view : found.views) DOCTEST_CHECK(view.branch == "text");
    DOCTEST_CHECK(iou(*found.label.bits, fixture.scene.first) > LeastIou);
}

DOCTEST_TEST_CASE("an added thing gets seeds where the attention of all views meets") {
    const Quiet quiet;
    Fixture fixture;
    const auto request = request_for("a ball with a hat", "hat");
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(found.mode == edit::EditMode::Add);
    DOCTEST_CHECK(found.region.origin == "attention");
    DOCTEST_CHECK(std::count(found.label.bits->begin(), found.label.bits->end(), 1) == 0);
    DOCTEST_CHECK(iou(*found.source_label.bits, fixture.scene.first) > 0.6);
    DOCTEST_REQUIRE(found.seeds.size() == static_cast<std::size_t>(request.seed_splats));
    Vec3 mean;
    for (std::size_t row = 0; row < found.seeds.size(); ++row)
        for (int axis = 0; axis < 3; ++axis)
            mean[axis] += found.seeds.position[row * 3 + static_cast<std::size_t>(axis)] /
                          static_cast<double>(found.seeds.size());
    DOCTEST_CHECK(length(mean - Vec3{-0.55, -0.5, 0}) < 0.35);  // above the red ball; up is -y
    const auto plan = edit::make_plan(fixture.input(request), found, *fixture.rasterizer);
    DOCTEST_CHECK(plan.seeds.size() == found.seeds.size());
    for (const auto& mask : plan.masks) DOCTEST_CHECK(mask.count() > 0);
}

DOCTEST_TEST_CASE("attention has to be surer of what is not there yet") {
    const Quiet quiet;
    Fixture fixture;
    const double level = fixture.attention.threshold();
    const auto least_inside = [&](const edit::CheckedRequest& request) {
        double least = 1;
        for (const auto& view : edit::locate(fixture.input(request), fixture.tools()).views)
            for (std::size_t i = 0; i < view.region.data.size(); ++i)
                if (view.region.data[i] != 0) least = std::min<double>(least, view.map.data[i]);
        return least;
    };
    const double there = least_inside(request_for("a blue ball", "blue")),
                 absent = least_inside(request_for("a ball with a hat", "hat"));
    DOCTEST_CHECK(absent >
                  there + 0.15 * level);  // a region is a little more than the pixels above the level
    DOCTEST_CHECK(absent < there + 0.25 * level);
}

DOCTEST_TEST_CASE("without agreement an added thing goes to its usual place") {
    const Quiet quiet;
    Fixture fixture;
    fixture.attention.hat_shift = 1000;  // the maps stay empty
    const auto request = request_for("a ball with a hat", "hat");
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(found.region.origin == "top");
    DOCTEST_CHECK(found.failed_views == 0);
    for (const auto& view : found.views) DOCTEST_CHECK(view.branch == "anchor");
    for (const auto& centre : found.region.centres) {
        DOCTEST_CHECK(centre.y < -0.25);
        DOCTEST_CHECK(std::hypot(centre.x + 0.55, centre.z) < 0.45);
    }
}

DOCTEST_TEST_CASE("an empty scene, no views and a stop are errors of their own") {
    const Quiet quiet;
    Fixture fixture;
    const auto request = request_for("a blue ball", "blue");
    const std::vector<View> none;
    DOCTEST_CHECK_THROWS_AS(
        edit::locate({fixture.scene.set, none, fixture.words, request, {}, {0, -1, 0}}, fixture.tools()),
        Error);
    const GaussianSet empty;
    DOCTEST_CHECK_THROWS_AS(
        edit::locate({empty, fixture.views, fixture.words, request, {}, {0, -1, 0}}, fixture.tools()), Error);
    std::stop_source stop;
    stop.request_stop();
    auto tools = fixture.tools();
    tools.job.stop = stop.get_token();
    try {
        edit::locate(fixture.input(request), tools);
        DOCTEST_CHECK(false);
    } catch (const Error& error) { DOCTEST_CHECK(error.code() == ErrorCode::Cancelled); }
}

DOCTEST_TEST_CASE("what the sentence replaces is looked for in the sentence as it was before") {
    const Quiet quiet;
    Fixture fixture;
    const auto request = request_for("a red cube on the snow", "cube");
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(found.mode == edit::EditMode::Replace);
    DOCTEST_REQUIRE_FALSE(fixture.attention.queries.empty());
    for (const auto& query : fixture.attention.queries) {
        DOCTEST_CHECK(query.word == "ball");
        DOCTEST_CHECK(query.prompt == "a ball on the snow");
    }
}

DOCTEST_TEST_CASE("another threshold asks no network, and remembered views and threads change nothing") {
    const Quiet quiet;
    auto request = request_for("a blue ball", "blue");
    Fixture fixture;
    edit::CachedAttention cached(std::make_unique<ColourAttention>());
    const auto segmenter = edit::make_default_segmenter();
    edit::LocateCache cache;
    ThreadPool threads(2);
    const auto find = [&](bool remembers) {
        edit::LocateTools tools{*fixture.rasterizer, cached, segmenter.get(), nullptr, {}};
        if (remembers) tools.cache = &cache, tools.threads = &threads;
        return edit::locate(fixture.input(request), tools);
    };
    find(true);
    const auto asked = cached.asked();
    DOCTEST_CHECK(cache.renders.size() == fixture.views.size());
    for (const double threshold : {0.35, 0.6}) {
        request.attention_threshold = threshold;
        const auto quick = find(true), plain = find(false);
        DOCTEST_CHECK(*quick.label.bits == *plain.label.bits);
        DOCTEST_CHECK(test::same_bytes(*quick.label.weight, *plain.label.weight));
        for (std::size_t v = 0; v < quick.views.size(); ++v) {
            DOCTEST_CHECK(quick.views[v].mask.data == plain.views[v].mask.data);
            DOCTEST_CHECK(quick.views[v].points.size() == plain.views[v].points.size());
        }
    }
    DOCTEST_CHECK(cached.asked() == asked);
}

DOCTEST_TEST_CASE("a threshold at which another view is at odds with the rest asks no network either") {
    const Quiet quiet;
    auto request = request_for("a blue ball", "blue");
    Fixture fixture;
    const auto asked_at = [&](double first, double then) {
        edit::CachedAttention cached(std::make_unique<DistractedAttention>());
        edit::LocateCache cache;
        edit::LocateTools tools{*fixture.rasterizer, cached, nullptr, nullptr, {}};
        tools.cache = &cache;
        std::vector<std::size_t> asked;
        for (const double threshold : {first, then}) {
            request.attention_threshold = threshold;
            edit::locate(fixture.input(request), tools);
            asked.push_back(cached.asked());
        }
        return asked;
    };
    const auto low = asked_at(0.3, 0.6), high = asked_at(0.6, 0.3);
    DOCTEST_CHECK(low[0] > high[0]);  // the view is asked again
    DOCTEST_CHECK(low[1] == low[0]);
    DOCTEST_CHECK(high[1] == high[0]);
}

DOCTEST_TEST_CASE(
    "attention is asked about whole phrases, in the sentence as every part of the model is told it") {
    const Quiet quiet;
    auto request = test::asked("beach ball", "A Blue, * beach ball on Grass!", "blue");
    Fixture fixture;
    const auto found = edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(found.word == "beach ball");
    DOCTEST_REQUIRE(!fixture.attention.queries.empty());
    const auto& query = fixture.attention.queries.front();
    DOCTEST_CHECK(query.prompt == language::normalised_prompt(request.prompt()));
    DOCTEST_CHECK(query.prompt == "a blue * beach ball on grass");
    // Its head is no rival of the phrase.
    DOCTEST_CHECK(query.words == std::vector<std::string>{"beach ball", "grass"});
    request.competing_words = "top hat, grass";
    edit::locate(fixture.input(request), fixture.tools());
    DOCTEST_CHECK(fixture.attention.queries.back().words ==
                  std::vector<std::string>{"beach ball", "top hat", "grass"});
}

DOCTEST_TEST_CASE("networks see a ground that is no part of the scene, and the views agree on it") {
    const Quiet quiet;
    const auto request = request_for("a blue ball", "blue");
    const auto seen = [&](const std::optional<edit::StudioBackground>& ground) {
        Fixture fixture;
        auto input = fixture.input(request);
        input.ground = ground;
        return edit::locate(input, fixture.tools());
    };
    const edit::StudioBackground plain{{{0, 2, 0}, 1, 1, 1}, {0, -1, 0}, {0, 0, 0.2f}, {0, 0, 0.5f}, 3};
    const auto before_black = seen({}), before_plain = seen(plain);
    DOCTEST_CHECK(*before_plain.label.bits == *before_black.label.bits);  // both are as red as black
    DOCTEST_CHECK(before_plain.on_ground);
    DOCTEST_CHECK_FALSE(before_black.on_ground);
    DOCTEST_CHECK(before_plain.views[0].render.at(0, 0, 2) == doctest::Approx(plain.sky[2]));
    DOCTEST_CHECK(before_black.views[0].render.at(0, 0, 2) == 0);
    DOCTEST_CHECK(before_plain.confidence.part("agreement") > before_black.confidence.part("agreement"));
    DOCTEST_CHECK(before_plain.confidence.part("labelled_share") <
                  before_black.confidence.part("labelled_share"));
}

DOCTEST_TEST_CASE("what wears an addition is looked for without it; a look stays in the sentence") {
    const Quiet quiet;
    Fixture hat;
    edit::locate(hat.input(request_for("a ball wearing a hat", "hat")), hat.tools());
    std::size_t of_ball = 0;
    for (const auto& query : hat.attention.queries) {
        DOCTEST_CHECK(query.prompt == (query.word == "ball" ? "a ball" : "a ball wearing a hat"));
        of_ball += query.word == "ball" ? 1 : 0;
    }
    DOCTEST_CHECK(of_ball > 0);
    DOCTEST_CHECK(of_ball < hat.attention.queries.size());
    Fixture blue;
    edit::locate(blue.input(request_for("a blue ball", "blue")), blue.tools());
    DOCTEST_CHECK(blue.attention.queries.front().prompt == "a blue ball");
}

}  // namespace locate_test
