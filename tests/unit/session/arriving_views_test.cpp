// Views of a search as they come in.
#include <doctest/doctest.h>

#include <algorithm>
#include <thread>

#include "app/session/state/arriving_views.h"

namespace arriving_views_test {

using namespace gse;
using app::ArrivingViews;

namespace {

constexpr int Side = 8;

View view_at(double x) {
    View view;
    view.name = "view";
    view.camera.width = view.camera.height = Side;
    view.camera.translation = {x, 0, 3};
    return view;
}

edit::ViewEvidence attended(float attention) {
    edit::ViewEvidence evidence;
    evidence.render = Image(Side, Side, 3, 0.5f);
    evidence.map = Image(Side, Side, 1, attention);
    return evidence;
}

std::ptrdiff_t here(const std::vector<pipeline::SeenView>& views) {
    return std::count_if(views.begin(), views.end(), [](const auto& view) { return view.render != nullptr; });
}

}  // namespace

DOCTEST_TEST_CASE("views come one by one, each with its mask once that is made") {
    ArrivingViews arriving;
    std::vector<pipeline::SeenView> views;
    DOCTEST_CHECK_FALSE(arriving.take(views));
    arriving.add(view_at(0), 0, 3, attended(0.2f));
    DOCTEST_REQUIRE(arriving.take(views));
    DOCTEST_CHECK(views.size() == 3);
    DOCTEST_CHECK(here(views) == 1);
    DOCTEST_CHECK(views[0].map->data[0] == 0.2f);
    DOCTEST_CHECK(views[0].mask == nullptr);
    DOCTEST_CHECK_FALSE(arriving.take(views));
    arriving.add(view_at(2), 2, 3, attended(0.4f));
    auto masked = attended(0.2f);
    masked.mask = Mask(Side, Side, 1);
    masked.branch = "points";
    arriving.add(view_at(0), 0, 3, masked);
    DOCTEST_REQUIRE(arriving.take(views));
    DOCTEST_CHECK(here(views) == 2);
    DOCTEST_CHECK(views[0].mask->count() == Side * Side);
    DOCTEST_CHECK(views[0].branch == "points");
    DOCTEST_CHECK(views[2].mask == nullptr);
}

DOCTEST_TEST_CASE("a search that moves in begins with empty places") {
    ArrivingViews arriving;
    std::vector<pipeline::SeenView> views;
    for (std::size_t v = 0; v < 3; ++v) arriving.add(view_at(static_cast<double>(v)), v, 3, attended(0.1f));
    arriving.add(view_at(50), 0, 3, attended(0.9f));  // as many views, from elsewhere
    DOCTEST_REQUIRE(arriving.take(views));
    DOCTEST_CHECK(here(views) == 1);
    arriving.add(view_at(50), 0, 5, attended(0.9f));  // from there, but more
    DOCTEST_REQUIRE(arriving.take(views));
    DOCTEST_CHECK(views.size() == 5);
    DOCTEST_CHECK(here(views) == 1);
}

DOCTEST_TEST_CASE("several threads may tell of views at once") {
    ArrivingViews arriving;
    constexpr std::size_t count = 40;
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t)
        threads.emplace_back([&arriving, t] {
            for (std::size_t v = t; v < count; v += 4)
                arriving.add(view_at(static_cast<double>(v)), v, count, attended(0.5f));
        });
    for (auto& thread : threads) thread.join();
    std::vector<pipeline::SeenView> views;
    DOCTEST_REQUIRE(arriving.take(views));
    DOCTEST_CHECK(here(views) == static_cast<std::ptrdiff_t>(count));
    for (std::size_t v = 0; v < count; ++v)
        DOCTEST_CHECK(views[v].camera.translation.x == static_cast<double>(v));
}

}  // namespace arriving_views_test
