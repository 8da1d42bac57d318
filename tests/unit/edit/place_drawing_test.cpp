// Places found by drawing: stand-ins paint a blue ball above the red one and attend to blue.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/masks/drawn_thing.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/search/make_plan.h"
#include "engine/edit/search/place_drawing.h"
#include "tests/unit/edit/edit_scenes.h"

namespace place_drawing_test {

namespace {

using namespace gse;

constexpr int Side = 48;
constexpr double HatRadius = 0.2;
const Vec3 Hat{-0.55, -0.55, 0};  // above the red ball; up is -y

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

/// "ball" is drawn to red pixels, "hat" to blue ones, and to a wide surrounding that the sentence alone
/// suggests.
class ColourAttention : public edit::AttentionSource {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        absent += query.absent ? 1 : 0;
        of_hat += query.words.front() == "hat" ? 1 : 0;
        const int channel = query.words.front() == "hat" ? 2 : 0;
        Image map(query.image.width, query.image.height, 1);
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x)
                map.at(x, y, 0) = std::max(channel == 2 ? Suggested : 0.0f,
                                           query.image.at(x, y, channel) - query.image.at(x, y, 1));
        if (broken && channel == 2) map.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
        return {map};
    }
    int image_size() const override { return Side; }
    int absent = 0, of_hat = 0;  // questions about what is not there, about the hat
    bool broken = false;         // a value of every map of the hat is not finite

private:
    static constexpr float Suggested = 0.2f;
};

/// Paints the hat where it belongs into the views; everything else a little differently, as an autoencoder
/// does.
class HatPainter : public edit::MultiViewEditor {
public:
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl&) override {
        asked.push_back(input);
        edit::EditedViews targets;
        for (const auto& view : views) {
            const auto& camera = view.view.camera;
            const Vec3 centre = camera.to_camera(Hat);
            const double u = camera.fx * centre.x / centre.z + camera.cx,
                         v = camera.fy * centre.y / centre.z + camera.cy;
            const double radius = camera.fx * HatRadius / centre.z;
            Image picture = view.rendered, change(picture.width, picture.height, 1, 0.02f),
                  outline(picture.width, picture.height, 1, 0.1f);
            for (auto& value : picture.data) value = std::min(1.0f, value + 0.02f);
            for (int y = 0; y < picture.height; ++y)
                for (int x = 0; x < picture.width; ++x) {
                    const double away = std::hypot(x + 0.5 - u, y + 0.5 - v);
                    if (soft)
                        // Half at the rim.
                        outline.at(x, y, 0) = static_cast<float>(std::clamp(1.5 - away / radius, 0.0, 1.0));
                    if (!paints || away > radius) continue;
                    for (int c = 0; c < 3; ++c) picture.at(x, y, c) = c == 2 ? 0.9f : 0.1f;
                    change.at(x, y, 0) = 0.6f;
                    if (!soft) outline.at(x, y, 0) = 0.9f;
                }
            if (breaks) picture.data.front() = std::numeric_limits<float>::quiet_NaN();
            targets.images.push_back(std::move(picture));
            if (tells) targets.changes.push_back(std::move(change));
            if (outlines) targets.outlines.push_back(std::move(outline));
            rooms.push_back(view.mask.count());
            corners.push_back(view.original.data.front());
            // All of the scene stays to be seen.
            DOCTEST_CHECK(view.clean_plate.picture.data == view.original.data);
        }
        return targets;
    }
    bool paints = true, tells = true, outlines = false, soft = false,
         breaks = false;  // breaks: the first value of each picture is not finite
    std::vector<edit::EditViewsRequest> asked;
    std::vector<std::size_t> rooms;
    std::vector<float> corners;  // the first value of what it was shown
};

struct Fixture {
    test::BallScene scene = test::ball_scene(200);
    std::vector<View> views = test::ball_views(12, Side);
    std::vector<std::string> words;
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    ColourAttention attention;
    HatPainter painter;
    edit::LocateCache cache;
    edit::CheckedRequest request;
    bool plain_ground = false;

    explicit Fixture(const std::string& prompt = "a ball wearing a hat")
        : request(test::asked("ball", prompt, "hat")) {
        request.place_views = 6;
    }
    edit::LocateResult locate(const std::vector<std::uint8_t>* label = nullptr) {
        edit::LocateTools tools{*rasterizer, attention, nullptr, nullptr, {}};
        tools.drawing = &painter;
        tools.cache = &cache;
        tools.plain_ground = plain_ground;
        return edit::locate({scene.set, views, words, request, {}, {0, -1, 0}, {0, 0, -1}, label}, tools);
    }
};

Vec3 middle(const edit::VoxelRegion& region) {
    Vec3 sum;
    for (const auto& centre : region.centres)
        sum = sum + centre * (1.0 / static_cast<double>(region.centres.size()));
    return sum;
}

}  // namespace

DOCTEST_TEST_CASE(
    "what the model changed is the thing, one of two parts without attention too; specks and lines are not") {
    constexpr double level = 0.5;
    Image change(Side, Side, 1, 0.02f), map(Side, Side, 1);
    Mask inside(Side, Side);
    std::fill(inside.data.begin(), inside.data.end(), std::uint8_t{1});
    const auto square = [](auto& image, int left, int top, int size, auto value) {
        for (int y = top; y < top + size; ++y)
            for (int x = left; x < left + size; ++x)
                image.data[static_cast<std::size_t>(y * Side + x)] = value;
    };
    square(change, 8, 16, 10, 0.5f),
        square(change, 30, 16, 10, 0.5f);  // two wings, of which the attention sees one
    square(map, 8, 16, 10, 1.0f);
    square(change, 20, 4, 2, 0.3f);                              // a speck
    for (int x = 0; x < Side; ++x) change.at(x, 40, 0) = 0.15f;  // an edge that the autoencoder blurs
    Mask found = edit::changed_thing(change, inside, map, level);
    const auto at = [&](int x, int y) { return found.at(x, y) != 0; };
    DOCTEST_CHECK((at(12, 20) && at(34, 20)));
    DOCTEST_CHECK((!at(20, 4) && !at(12, 40) && !at(24, 20)));
    square(change, 8, 16, 10, 0.05f);  // dark before the dark: only the attention makes it sure
    found = edit::changed_thing(change, inside, map, level);
    DOCTEST_CHECK((at(12, 20) && at(34, 20)));
    square(map, 8, 16, 10, 0.4f);
    found = edit::changed_thing(change, inside, map, level);
    DOCTEST_CHECK((!at(12, 20) && at(34, 20)));
    square(inside, 30, 16, 10, std::uint8_t{0});
    DOCTEST_CHECK(edit::changed_thing(change, inside, map, level).count() == 0);
}

DOCTEST_TEST_CASE(
    "what the model tells of a thing keeps its soft rim; specks, holes and what is not a number are mended") {
    Image told(Side, Side, 1, 0.02f);
    Mask inside(Side, Side);
    std::fill(inside.data.begin(), inside.data.end(), std::uint8_t{1});
    for (int y = 10; y < 30; ++y)
        for (int x = 10; x < 30; ++x)
            told.at(x, y, 0) = x == 10 ? 0.3f : 0.95f;  // half a pixel reaches out on the left
    told.at(20, 20, 0) = 0.1f;                          // a hole
    told.at(44, 44, 0) = 0.9f;                          // a speck
    told.at(25, 25, 0) = std::numeric_limits<float>::quiet_NaN();
    for (int y = 10; y < 30; ++y) inside.at(29, y) = 0;
    const Image share = edit::told_thing(told, inside);
    const Mask mask = edit::covered_pixels(share);
    DOCTEST_CHECK(mask.count() == 18 * 20);
    DOCTEST_CHECK((share.at(10, 20, 0) == 0.3f && mask.at(10, 20) == 0));
    DOCTEST_CHECK((share.at(20, 20, 0) == 1 && share.at(25, 25, 0) == 1));
    for (const auto& [x, y] : {std::pair{44, 44}, std::pair{29, 20}, std::pair{2, 2}})
        DOCTEST_CHECK(share.at(x, y, 0) == 0);
    for (auto& value : told.data) value *= 0.5f;
    DOCTEST_CHECK(edit::covered_pixels(edit::told_thing(told, inside)).count() == 0);
}

DOCTEST_TEST_CASE("something added goes where a model that is shown the scene draws it") {
    const Quiet quiet;
    for (const char* known : {"outlines", "changes", "nothing"}) {
        Fixture fixture;
        fixture.painter.outlines = known == std::string("outlines");
        fixture.painter.tells = known == std::string("changes");
        const auto found = fixture.locate(&fixture.scene.first);
        DOCTEST_REQUIRE(found.mode == edit::EditMode::Add);
        DOCTEST_CHECK(found.region.origin == "attention");
        DOCTEST_CHECK(length(middle(found.region) - Hat) < 0.1);
        const double volume =
            static_cast<double>(found.region.centres.size()) * std::pow(found.region.side, 3);
        const double ball = 4.0 / 3 * 3.14159 * std::pow(HatRadius, 3);
        DOCTEST_CHECK(volume > 0.5 * ball);
        DOCTEST_CHECK(volume < 2.5 * ball);
        DOCTEST_CHECK(fixture.attention.absent == 0);  // nothing is asked about what is not there
        // Nor where the model tells.
        DOCTEST_CHECK(fixture.attention.of_hat == (fixture.painter.outlines ? 0 : 6));
        DOCTEST_CHECK(found.failed_views == 0);
        // What was drawn is blue, and so all views are told where the sentence says no colour.
        const auto plan =
            edit::make_plan({fixture.scene.set, fixture.views, fixture.words, fixture.request, {}}, found,
                            *fixture.rasterizer);
        DOCTEST_CHECK(plan.drawn_colour == "blue");
    }
}

DOCTEST_TEST_CASE(
    "what stands in nothing is shown on a plain ground, where the model tells outlines of what it draws "
    "there") {
    const Quiet quiet;
    for (const bool outlines : {true, false}) {
        Fixture fixture;
        fixture.plain_ground = true;
        fixture.painter.outlines = outlines;
        DOCTEST_CHECK(fixture.locate(&fixture.scene.first).problem == edit::SearchProblem::None);
        DOCTEST_REQUIRE(fixture.painter.asked.size() == (outlines ? 1 : 2));
        DOCTEST_CHECK(fixture.painter.corners.front() > 0.5f);  // the sky
        DOCTEST_CHECK((fixture.painter.corners.back() == 0) == !outlines);
    }
}

DOCTEST_TEST_CASE("the place is drawn from nothing, in as many views as asked for, once for all thresholds") {
    const Quiet quiet;
    Fixture fixture;
    fixture.locate(&fixture.scene.first);
    DOCTEST_REQUIRE(fixture.painter.asked.size() == 1);
    const auto& input = fixture.painter.asked.front();
    DOCTEST_CHECK((input.anew && input.keep && input.tells_changes && input.strength == 1 &&
                   input.steps == fixture.request.place_steps));
    DOCTEST_CHECK(input.noise == fixture.request.add_noise);
    DOCTEST_CHECK(fixture.painter.rooms.size() == 6);
    fixture.request.attention_threshold = 0.6;
    fixture.locate(&fixture.scene.first);
    DOCTEST_CHECK(fixture.painter.asked.size() == 1);
    fixture.request.add_room = 0.9;
    fixture.locate(&fixture.scene.first);
    DOCTEST_REQUIRE(fixture.painter.rooms.size() == 12);
    for (std::size_t v = 0; v < 6; ++v)
        DOCTEST_CHECK(fixture.painter.rooms[6 + v] > fixture.painter.rooms[v]);
    auto other = fixture.scene.first;
    other.front() = 0;
    fixture.locate(&other);
    DOCTEST_CHECK(fixture.painter.asked.size() == 3);
    fixture.request.add_noise = 1;
    fixture.locate(&other);
    DOCTEST_REQUIRE(fixture.painter.asked.size() == 4);
    DOCTEST_CHECK(fixture.painter.asked.back().noise == 1);
}

DOCTEST_TEST_CASE("a threshold that is asked for is that of told outlines, too") {
    const Quiet quiet;
    const auto cubes = [](double threshold) {
        Fixture fixture;
        fixture.painter.outlines = fixture.painter.soft = true;
        fixture.request.attention_threshold = threshold;
        return fixture.locate(&fixture.scene.first).region;
    };
    const auto volume = [](const edit::VoxelRegion& region) {
        return static_cast<double>(region.centres.size()) * std::pow(region.side, 3);
    };
    const double usual = volume(cubes(0)), wide = volume(cubes(0.2)), narrow = volume(cubes(0.8));
    DOCTEST_CHECK(wide > 1.2 * usual);
    DOCTEST_CHECK(narrow < usual / 1.2);
    DOCTEST_CHECK(narrow > 0);
}

DOCTEST_TEST_CASE(
    "attention of drawn pictures that is not finite is counted; a drawn value that is not finite stays as "
    "the scene is") {
    const Quiet quiet;
    Fixture fixture;
    fixture.attention.broken = fixture.painter.breaks = true;
    const auto found = fixture.locate(&fixture.scene.first);
    DOCTEST_CHECK(found.broken_attention == 6);
    DOCTEST_CHECK(length(middle(found.region) - Hat) < 0.1);
    for (const auto& view : found.views) {
        if (view.drawn.data.empty()) continue;
        DOCTEST_CHECK(view.drawn.data.front() == view.render.data.front());
        for (const float value : view.drawn.data) DOCTEST_REQUIRE(std::isfinite(value));
    }
}

DOCTEST_TEST_CASE("what is not drawn, or has a place that the sentence names, is looked for by attention") {
    const Quiet quiet;
    Fixture blank, beside("a hat beside a ball"), off;
    blank.painter.paints = false;
    blank.locate(&blank.scene.first);
    DOCTEST_CHECK(blank.painter.asked.size() == 1);
    DOCTEST_CHECK(blank.attention.absent > 0);
    beside.locate();  // also where the source itself was looked for before
    DOCTEST_CHECK(beside.painter.asked.empty());
    DOCTEST_CHECK(beside.attention.absent > 0);
    off.request.place_views = 0;
    off.locate(&off.scene.first);
    DOCTEST_CHECK(off.painter.asked.empty());
}

}  // namespace place_drawing_test
