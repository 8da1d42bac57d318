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
