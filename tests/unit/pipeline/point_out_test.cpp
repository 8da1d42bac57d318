// Things under a click on a picture, and the largest that stands alone.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/pipeline/select/point_out.h"
#include "engine/pipeline/select/scene_ground.h"
#include "engine/pipeline/select/whole_thing.h"

namespace point_out_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

constexpr std::size_t BallRows = 6000, TableRows = 20000;

/// A red ball of radius 0.3 on a brown table of thickness 0; the ball's rows come first. Up is -y.
Scene ball_on_table() {
    Random random(3);
    GaussianData data;
    data.resize(BallRows + TableRows);
    for (std::size_t row = 0; row < data.size(); ++row) {
        const bool ball = row < BallRows;
        Vec3 at{random.uniform(-1, 1), 0, random.uniform(-1, 1)};
        if (ball) {
            const double z = random.uniform(-1, 1), turn = random.uniform(0, 6.2832),
                         r = std::sqrt(1 - z * z);
            at = Vec3{0.4, -0.3, 0} + Vec3{r * std::cos(turn), z, r * std::sin(turn)} * 0.3;
        }
        for (int axis = 0; axis < 3; ++axis) {
            const auto place = row * 3 + static_cast<std::size_t>(axis);
            data.position[place] = static_cast<float>(at[axis]);
            data.log_scale[place] = -4.2f;
        }
        data.rotation[row * 4] = 1, data.opacity_logit[row] = 4;
        data.sh[row * 3] = ball ? 1.4f : 0.2f, data.sh[row * 3 + 1] = ball ? -1.2f : -0.3f;
        data.sh[row * 3 + 2] = ball ? -1.2f : -0.8f;
    }
    Scene scene;
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

/// Share of the ball that is labelled, and of the table.
std::pair<double, double> shares(const std::vector<std::uint8_t>& rows) {
    const auto middle = rows.begin() + BallRows;
    return {static_cast<double>(std::count(rows.begin(), middle, std::uint8_t{1})) / BallRows,
            static_cast<double>(std::count(middle, rows.end(), std::uint8_t{1})) / TableRows};
}

ClickRequest looking(double x, double y) {
    ClickRequest request;
    request.camera = Camera::look_at({0, -1.5, -3}, {0, 0, 0}, {0, -1, 0}, 0.9, 640, 480);
    request.x = x, request.y = y;
    return request;
}

/// Click on a point of the world.
ClickRequest on(const Vec3& point) {
    auto request = looking(0, 0);
    const Vec3 at = request.camera.to_camera(point);
    request.x = request.camera.fx * at[0] / at[2] + request.camera.cx;
    request.y = request.camera.fy * at[1] / at[2] + request.camera.cy;
    return request;
}

}  // namespace

DOCTEST_TEST_CASE("a click takes the thing under it on all sides, without the table, and the other way") {
    const auto scene = ball_on_table();
    const auto thing = thing_at(scene.gaussians, on({0.4, -0.35, -0.25}));
    const auto [ball, table] = shares(thing.rows);
    DOCTEST_CHECK(ball > 0.95);
    DOCTEST_CHECK(table < 0.02);
    DOCTEST_CHECK(parted_text(thing) == "parted from what it stands on");
    auto ground = on({-0.7, 0, -0.5});
    ground.ground = true;
    const auto [on_ball, on_table] = shares(thing_at(scene.gaussians, ground).rows);
    DOCTEST_CHECK(on_ball < 0.12);  // where it touches the table
    DOCTEST_CHECK(on_table > 0.95);
}

DOCTEST_TEST_CASE(
    "a label that is most of a thing has its whole; half of one, or what reaches beyond it, has none") {
    const auto scene = ball_on_table();
    const auto& position = scene.gaussians.position();
    const OrbitParameters orbit;
    /// Rows of the ball up to a height above the table, and of the table up to a place along x.
    const auto labelled = [&](double height, double along) {
        std::vector<std::uint8_t> label(scene.gaussians.size(), 0);
        for (std::size_t row = 0; row < label.size(); ++row)
            label[row] = row < BallRows ? -position[row * 3 + 1] < height : position[row * 3] < along;
        return label;
    };
    constexpr double all = 1, none = -2;
    for (const double height : {0.5, 0.6}) {  // of 0.6: a sphere has equal rows at all heights
        const auto whole = whole_thing(scene.gaussians, labelled(height, none), orbit);
        DOCTEST_REQUIRE(!whole.empty());
        const auto [ball, table] = shares(whole);
        DOCTEST_CHECK(ball > 0.95);
        DOCTEST_CHECK(table < 0.02);
    }
    DOCTEST_CHECK(whole_thing(scene.gaussians, labelled(0.3, none), orbit).empty());
    DOCTEST_CHECK(whole_thing(scene.gaussians, labelled(all, -0.5), orbit).empty());
    DOCTEST_CHECK(whole_thing(scene.gaussians, labelled(-all, none), orbit).empty());
}

DOCTEST_TEST_CASE("a box around a part takes what fills it, and a box that holds the whole thing says so") {
    const auto scene = ball_on_table();
    const auto& position = scene.gaussians.position();
    std::vector<std::uint8_t> ball(scene.gaussians.size(), 0), cap(ball);
    for (std::size_t row = 0; row < BallRows; ++row) ball[row] = 1, cap[row] = position[row * 3 + 1] < -0.5f;
    auto middle = on({0.4, -0.35, -0.25});
    const auto bounds = [&](const Vec3& low, const Vec3& high) {
        const auto first = on(low), last = on(high);
        return edit::BoxPrompt{first.x, first.y, last.x, last.y};
    };
    const auto around_ball = bounds({0.1, -0.6, 0}, {0.7, 0, 0}),
               around_cap = bounds({0.2, -0.6, 0}, {0.6, -0.5, 0});
    DOCTEST_CHECK(boxed_part(scene.gaussians, middle, around_ball, cap).rows == cap);  // no part is meant
    middle.part = true;
    const auto [grown, another] = boxed_part(scene.gaussians, middle, around_ball, cap);
    DOCTEST_CHECK(shares(grown).first > 0.95);
    DOCTEST_CHECK(another.find("another part") != std::string::npos);
    DOCTEST_CHECK(boxed_part(scene.gaussians, middle, around_cap, cap).rows == cap);
    const auto [whole, all] = boxed_part(scene.gaussians, middle, around_ball, ball);
    DOCTEST_CHECK(whole == ball);
    DOCTEST_CHECK(all.find("holds all") != std::string::npos);
}

DOCTEST_TEST_CASE("a label that is most of the ground has the whole of it") {
    const auto scene = ball_on_table();
    const auto labelled = [&](float along) {
        std::vector<std::uint8_t> label(scene.gaussians.size(), 0);
        for (auto row = BallRows; row < label.size(); ++row)
            label[row] = scene.gaussians.position()[row * 3] < along;
        return label;
    };
    const Vec3 up{0, -1, 0};
    const auto [ball, table] = shares(whole_ground(scene.gaussians, labelled(0.5f), up, {}));
    DOCTEST_CHECK(ball < 0.12);
    DOCTEST_CHECK(table > 0.95);
    DOCTEST_CHECK(whole_ground(scene.gaussians, labelled(-0.5f), up, {}) == labelled(-0.5f));
}

DOCTEST_TEST_CASE("a click beside everything takes nothing; the largest thing needs none") {
    const auto scene = ball_on_table();
    const auto nothing = thing_at(scene.gaussians, looking(2, 2));
    DOCTEST_CHECK(std::count(nothing.rows.begin(), nothing.rows.end(), std::uint8_t{1}) == 0);
    DOCTEST_CHECK(parted_text(nothing).empty());
    const auto [ball, table] = shares(largest_thing(scene.gaussians, {0, -1, 0}).rows);
    DOCTEST_CHECK(ball > 0.95);
    DOCTEST_CHECK(table < 0.02);
    std::stop_source source;
    source.request_stop();
    JobControl control;
    control.stop = source.get_token();
    DOCTEST_CHECK_THROWS_WITH_AS(thing_at(scene.gaussians, looking(2, 2), control),
                                 doctest::Contains("stopped"), Error);
}

DOCTEST_TEST_CASE("a place in words is one in the picture of the render command, or is said to be none") {
    const auto scene = ball_on_table();
    const auto plain = click_request("0.25,0.75", scene, "auto");
    const auto looked = choose_camera(scene, {}, RenderParameters{});
    DOCTEST_CHECK(plain.x == doctest::Approx(0.25 * looked.width));
    DOCTEST_CHECK(plain.y == doctest::Approx(0.75 * looked.height));
    DOCTEST_CHECK(length(plain.camera.centre() - looked.centre()) == 0);
    RenderParameters other;
    other.azimuth = 180, other.elevation = 20;
    const auto centre = [&](const char* text) { return click_request(text, scene, "auto").camera.centre(); };
    DOCTEST_CHECK(length(centre("0.5,0.5,180,20") - choose_camera(scene, {}, other).centre()) == 0);
    other.zoom = 2;
    DOCTEST_CHECK(length(centre("0.5,0.5,180,20,2") - choose_camera(scene, {}, other).centre()) == 0);
    DOCTEST_CHECK(azimuth_of_click("0.5,0.5,180,20") == 180);
    for (const char* wrong : {"", "0.5", "a,b", "0.5,0.5,", "0.5,0.5,180", "0.5,0.5,180,20,1,1", "nan,0.5",
                              "0.5,1.1", "-0.1,0.5", "0.5,0.5,0,95", "0.5,0.5,0,0,0", "0.5 0.5"})
        DOCTEST_CHECK_THROWS_AS(click_request(wrong, scene, "auto"), Error);
}

}  // namespace point_out_test
