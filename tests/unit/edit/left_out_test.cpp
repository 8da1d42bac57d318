// Views that an artist leaves out of the vote, and what is told of views while a search looks.
#include <doctest/doctest.h>

#include <map>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/thread_pool.h"
#include "engine/edit/masks/search_outcome.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/search/locate.h"
#include "tests/unit/edit/edit_scenes.h"

namespace left_out_test {

using namespace gse;

namespace {

constexpr int Side = 48;
constexpr std::size_t Wrong = 4;  // the view that looks at the other ball

/// "ball" is drawn to what is red; in one view, told by its picture, to what is green.
class MisledAttention : public edit::AttentionSource {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        const bool misled = !wrong.data.empty() && query.image.data == wrong.data;
        std::vector<Image> maps;
        for (std::size_t word = 0; word < query.words.size(); ++word) {
            Image map(query.image.width, query.image.height, 1);
            for (int y = 0; y < map.height && word == 0; ++y)
                for (int x = 0; x < map.width; ++x) {
                    const float lead = query.image.at(x, y, 0) - query.image.at(x, y, 1);
                    map.at(x, y, 0) = std::max(0.0f, misled ? scale * -lead : lead);
                }
            maps.push_back(std::move(map));
        }
        return maps;
    }
    int image_size() const override { return Side; }
    Image wrong;
    float scale = 1;  // of what it draws in that view
};

struct Search {
    test::BallScene scene = test::ball_scene(200);
    std::vector<View> views = test::ball_views(10, Side);
    std::vector<std::string> words;
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    MisledAttention attention;
    edit::CheckedRequest request = test::asked("ball", "a blue ball", "blue");

    Search() {
        log::set_level(log::Level::Off);
        request.retry_passes = 0;
        attention.wrong = run().views[Wrong].render;
    }
    ~Search() { log::set_level(log::Level::Info); }
    edit::LocateResult run(decltype(edit::LocateTools::seen) seen = {}) {
        edit::LocateTools tools{*rasterizer, attention, nullptr, nullptr, {}};
        tools.seen = std::move(seen);
        return edit::locate({scene.set, views, words, request, {}, {0, -1, 0}}, tools);
    }
};

}  // namespace

DOCTEST_TEST_CASE("lists of views: text to numbers and back") {
    DOCTEST_CHECK(edit::excluded_views_of("").empty());
    DOCTEST_CHECK(edit::excluded_views_of(" 17,3 , 3") == std::vector<std::size_t>{3, 17});
    DOCTEST_CHECK(edit::with_view("17, 3", 5, true) == "3, 5, 17");
    DOCTEST_CHECK(edit::with_view("3, 5", 5, true) == "3, 5");
    DOCTEST_CHECK(edit::with_view("3, 5, 17", 5, false) == "3, 17");
    DOCTEST_CHECK(edit::with_view("5", 5, false).empty());
    for (const char* wrong : {"front", "3;4", "-1", "3.5", "99999999999999999999999"})
        DOCTEST_CHECK_THROWS_AS(edit::excluded_views_of(wrong), Error);
    edit::EditRequest request;
    request.source = "ball", request.prompt = "a blue ball", request.excluded_views = "third";
    DOCTEST_CHECK_THROWS_AS(edit::check(request).plain(), Error);
}

DOCTEST_TEST_CASE("a view that is left out has no say: the label is that of a search without it") {
    Search search;
    const auto misled = search.run();
    search.request.excluded_views = std::to_string(Wrong);
    const auto without = search.run();
    DOCTEST_CHECK(without.found.field.probability != misled.found.field.probability);
    DOCTEST_CHECK(without.views.size() == search.views.size());
    for (std::size_t v = 0; v < without.views.size(); ++v) {
        DOCTEST_CHECK((without.views[v].step == edit::ViewStep::LeftOut) == (v == Wrong));
        DOCTEST_CHECK(without.views[v].failed == (v == Wrong));
    }
    DOCTEST_CHECK(without.views[Wrong].mask.data == misled.views[Wrong].mask.data);  // still to be seen
    DOCTEST_CHECK(without.confidence.value > misled.confidence.value);
    Search fewer;
    fewer.attention.wrong = {};
    fewer.views.erase(fewer.views.begin() + Wrong);
    const auto expected = fewer.run();
    DOCTEST_CHECK(without.found.field.probability == expected.found.field.probability);
    DOCTEST_CHECK(*without.label.bits == *expected.label.bits);
    DOCTEST_CHECK(without.confidence.value == doctest::Approx(expected.confidence.value));
}

DOCTEST_TEST_CASE(
    "so many views can be left out that too few are left, and a view that is not there cannot") {
    Search search;
    search.request.excluded_views = "0, 1, 2, 3, 4, 5, 6, 7";
    const auto few = search.run();
    DOCTEST_CHECK(few.problem == edit::SearchProblem::FewViews);
    DOCTEST_CHECK(few.message.find("2 of 2 views") != std::string::npos);
    search.request.excluded_views = "10";
    DOCTEST_CHECK_THROWS_WITH_AS(
        search.run(), doctest::Contains("view 10 is to be left out, but the last one is 9"), Error);
}

DOCTEST_TEST_CASE(
    "a view in which the word draws much less attention than in the others has no say, and tells why") {
    Search search;
    search.request.excluded_views = std::to_string(Wrong);
    const auto without = search.run();
    search.request.excluded_views.clear();
    search.attention.scale = 0.3f;
    const auto faint = search.run();
    for (std::size_t v = 0; v < faint.views.size(); ++v)
        DOCTEST_CHECK((faint.views[v].step == edit::ViewStep::Faint) == (v == Wrong));
    DOCTEST_CHECK(faint.views[Wrong].failed);
    DOCTEST_CHECK(faint.views[Wrong].mask.count() == 0);
    DOCTEST_CHECK(*faint.label.bits == *without.label.bits);
    DOCTEST_CHECK(edit::step_text(edit::ViewStep::Faint).find("out of sight") != std::string::npos);
}

DOCTEST_TEST_CASE("faint is what is far below most, in at most half of the views") {
    DOCTEST_CHECK(edit::faint_views({}).empty());
    DOCTEST_CHECK(edit::faint_views({0.5f, 0.4f, 0.45f, 0.5f}).empty());
    DOCTEST_CHECK(edit::faint_views({0.5f, 0.1f, 0.45f, 0.5f}) == std::vector<std::size_t>{1});
    DOCTEST_CHECK(edit::faint_views({0.1f, 0.1f, 0.1f, 0.5f}).empty());  // most are so
    DOCTEST_CHECK(edit::faint_views({0.1f, 0.12f, 0.45f, 0.5f, 0.5f}).size() == 2);
    DOCTEST_CHECK(edit::faint_views(std::vector<float>(5, 0.0f)).empty());
}

DOCTEST_TEST_CASE("something new is not put where only a view says that was left out") {
    Search search;
    search.request = search.request.reworded("a ball with a hat", "hat");
    search.request.mode = edit::EditMode::Add;
    search.request.excluded_views = std::to_string(Wrong);
    const auto located = search.run();
    DOCTEST_CHECK(located.views[Wrong].step == edit::ViewStep::LeftOut);
    DOCTEST_CHECK(located.views[Wrong].failed);
    // That was found by all.
    DOCTEST_CHECK(*located.source_label.bits != std::vector<std::uint8_t>(located.source_label.bits->size()));
}

DOCTEST_TEST_CASE("a search tells of every view as it is attended, then with its mask") {
    Search search;
    std::map<std::size_t, int> attended, masked;
    std::vector<std::size_t> order;
    const auto located = search.run([&](std::size_t view, const edit::ViewEvidence& evidence) {
        DOCTEST_CHECK(evidence.map.width == Side);
        ++(evidence.mask.data.empty() ? attended : masked)[view];
        order.push_back(view);
    });
    DOCTEST_CHECK(attended.size() == search.views.size());
    DOCTEST_CHECK(masked.size() == search.views.size());
    DOCTEST_CHECK(order.front() == 0);
    DOCTEST_CHECK(order[1] == 1);  // one by one, not all at the end
    for (const auto& [view, times] : masked) DOCTEST_CHECK(times == 1);
}

}  // namespace left_out_test
