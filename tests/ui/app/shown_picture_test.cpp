// Pictures of what the window shows: screenshots, the colour of a pixel, views, recent files, results.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/session/application.h"
#include "engine/io/image/image_file.h"
#include "tests/ui/app/session.h"

namespace shown_picture_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr float Byte = 1.5f / 255;  // of a channel that went through 8 bits

/// Largest difference of a channel over columns [first, last).
float difference(const Image& a, const Image& b, int first, int last) {
    float most = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = first; x < last; ++x)
            for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a.at(x, y, c) - b.at(x, y, c)));
    return most;
}

}  // namespace

DOCTEST_TEST_CASE("a screenshot shows what the viewport shows: its size, its tint, its wipe") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    session.label_the_middle(40);
    auto exports = app.model().exports;
    DOCTEST_CHECK(exports.as_shown);  // unless the artist says otherwise
    const auto written = [&](const char* name) {
        exports.picture_path = (place.folder / name).string();
        app.run(command::SetExports{exports});
        app.update(session.preview);
        app.run(command::ExportPicture{});
        DOCTEST_REQUIRE(session.idle());
        return read_image(place.folder / name);
    };
    const Image tinted = written("tinted.png");
    DOCTEST_REQUIRE(tinted.width == 320);
    DOCTEST_REQUIRE(tinted.height == 240);
    auto view = app.model().view;
    view.tint_labels = false;
    app.run(command::SetViewSettings{view});
    const Image plain = written("plain.png");
    DOCTEST_CHECK(difference(tinted, plain, 0, 320) > 0.2f);
    // The colour seen at a pixel is picked there.
    app.run(command::PickColour{150, 110});
    for (int c = 0; c < 3; ++c)
        DOCTEST_CHECK(std::abs(app.model().seen_colour.colour[static_cast<std::size_t>(c)] -
                               plain.at(150, 110, c)) < Byte);
    app.run(command::DeleteLabelledSplats{});
    app.run(command::SetComparison{ui::Comparison::Wipe});
    const Image wiped = written("wiped.png");
    DOCTEST_CHECK(difference(wiped, plain, 0, 159) < Byte);  // before
    DOCTEST_CHECK(difference(wiped, plain, 161, 320) > 0.2f);
    exports.as_shown = false;
    exports.width = 80, exports.height = 60;
    DOCTEST_CHECK(written("other.png").width == 80);
    app.shut_down();
}

namespace {

/// Pixels within `reach` of a place at which two pictures differ clearly.
int differing_near(const Image& a, const Image& b, double x, double y, int reach) {
    int count = 0;
    for (int py = std::max(0, static_cast<int>(y) - reach); py <= std::min(a.height - 1.0, y + reach); ++py)
        for (int px = std::max(0, static_cast<int>(x) - reach); px <= std::min(a.width - 1.0, x + reach);
             ++px)
            for (int c = 0; c < 3; ++c)
                if (std::abs(a.at(px, py, c) - b.at(px, py, c)) > 0.1f) {
                    ++count;
                    break;
                }
    return count;
}

}  // namespace

DOCTEST_TEST_CASE("a screenshot has the axes, the bounds and the cameras that the viewport shows") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto exports = app.model().exports;
    const auto written = [&](const char* name, auto&& change) {
        exports.picture_path = (place.folder / name).string();
        app.run(command::SetExports{exports});
        auto view = app.model().view;
        view.show_axes = view.show_bounds = view.show_views = false;
        change(view);
        app.run(command::SetViewSettings{view});
        app.update(session.preview);
        app.run(command::ExportPicture{});
        DOCTEST_REQUIRE(session.idle());
        return read_image(place.folder / name);
    };
    Camera camera = app.model().camera;
    camera.translation.z += 2 * app.model().orbit.radius;  // from afar all of the bounds are in the picture
    DOCTEST_REQUIRE(session.until([&] { return app.model().statistics.count > 0; }, 30));
    Camera other = camera;  // seen by the first one, in the middle of its picture
    const Vec3 aside = camera.centre() + camera.forward() * (0.5 * app.model().orbit.radius);
    other.translation = other.rotation * aside * -1.0;
    app.run(command::SetCamera{other});
    app.update(session.preview);
    app.run(command::AddView{});
    app.run(command::SetCamera{camera});
    app.update(session.preview);
    const Image plain = written("plain.png", [](auto&) {});
    const Image axes = written("axes.png", [](auto& view) { view.show_axes = true; });
    const Image bounds = written("bounds.png", [](auto& view) { view.show_bounds = true; });
    const Image views = written("views.png", [](auto& view) { view.show_views = true; });
    exports.transparent = true;
    const Image clear = written("clear.png", [](auto& view) { view.show_axes = true; });
    const auto at = [&](const Vec3& world) { return camera.to_camera(world); };
    // Axes: in the lower left corner, and nowhere else.
    constexpr double Corner = 46;  // of letters of 15 pixels
    DOCTEST_CHECK(differing_near(axes, plain, Corner, 240 - Corner, 45) > 100);
    DOCTEST_CHECK(differing_near(axes, plain, 220, 100, 100) == 0);
    DOCTEST_CHECK(differing_near(clear, plain, Corner, 240 - Corner, 45) > 100);
    // Bounds: at every corner of the box that is in the picture.
    const auto& statistics = app.model().statistics;
    int corners = 0;
    for (int bits = 0; bits < 8; ++bits) {
        const Vec3& low = statistics.robust_low;
        const Vec3& high = statistics.robust_high;
        const Vec3 p = at({bits & 1 ? high.x : low.x, bits & 2 ? high.y : low.y, bits & 4 ? high.z : low.z});
        const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
        if (p.z <= 0 || x < 2 || y < 2 || x > 317 || y > 237) continue;
        ++corners;
        DOCTEST_CHECK(differing_near(bounds, plain, x, y, 2) > 0);
    }
    DOCTEST_CHECK(corners == 8);
    // Cameras: where the stored one stands.
    DOCTEST_CHECK(differing_near(views, plain, camera.cx, camera.cy, 6) > 8);
    app.shut_down();
}

DOCTEST_TEST_CASE("views have names and pictures, and so have recent files") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    DOCTEST_REQUIRE(session.until(
        [&] { return !app.model().recent_pictures.empty() && app.model().recent_pictures[0] != nullptr; }));
    DOCTEST_CHECK(app.model().recent_pictures.size() == app.model().recent.size());
    const auto views = app.document().state().views.size();
    app.run(command::AddView{});
    app.run(command::RenameView{views, "from the left"});
    DOCTEST_CHECK(app.document().state().views.at(views).name == "from the left");
    app.run(command::DrawView{views});
    DOCTEST_REQUIRE(session.until([&] {
        const auto& pictures = app.model().view_pictures;
        return pictures.size() == views + 1 && pictures[views] != nullptr;
    }));
    const Image& picture = *app.model().view_pictures[views];
    const auto [low, high] = std::minmax_element(picture.data.begin(), picture.data.end());
    DOCTEST_CHECK(*high - *low > 0.3f);  // of the scene, not of its background alone
    app.run(command::DeleteView{views});
    DOCTEST_CHECK(app.model().view_pictures.size() <= views);
    app.shut_down();
    Session later;  // another start of the program
    DOCTEST_REQUIRE(!later.app.model().recent_pictures.empty());
    DOCTEST_CHECK(later.app.model().recent_pictures[0] != nullptr);
    later.app.shut_down();
}

DOCTEST_TEST_CASE("the picture of a result is large, and what was changed fills most of it") {
    if (!networks()) return;
    constexpr int LeastPx = 256;          // of a side, to be judged
    constexpr double LeastHeight = 0.35;  // of the picture, that the bear of the sample takes
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 2;
    app.run(command::SetRequest{request});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().results.size() == 1);
    const auto picture = app.model().results[0].thumbnail;
    DOCTEST_REQUIRE(picture != nullptr);
    DOCTEST_CHECK(picture->width >= LeastPx);
    int rows = 0;  // that show something redder than the grass around, as the bear is
    for (int y = 0; y < picture->height; ++y) {
        bool bear = false;
        for (int x = 0; x < picture->width; ++x)
            bear = bear || picture->at(x, y, 0) > picture->at(x, y, 1) + 0.05f;
        rows += bear ? 1 : 0;
    }
    DOCTEST_CHECK(rows > LeastHeight * picture->height);
    app.shut_down();
}

}  // namespace shown_picture_test
