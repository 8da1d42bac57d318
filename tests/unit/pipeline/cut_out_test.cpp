// Things cut out of the picture by a box around them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/select/box_cut.h"
#include "engine/pipeline/select/box_support.h"
#include "engine/pipeline/select/cut_out.h"
#include "engine/pipeline/select/cut_out_sides.h"

namespace cut_out_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

constexpr std::size_t BallRows = 3000, WallRows = 6000;

/// A red ball of radius 0.5 in front of a green wall; the ball's rows come first.
GaussianSet ball_and_wall() {
    Random random(4);
    GaussianData data;
    data.resize(BallRows + WallRows);
    for (std::size_t row = 0; row < BallRows + WallRows; ++row) {
        const bool ball = row < BallRows;
        float* at = &data.position[row * 3];
        if (ball) {
            const double z = random.uniform(-1, 1), turn = random.uniform(0, 6.2832),
                         r = std::sqrt(1 - z * z);
            at[0] = static_cast<float>(0.5 * r * std::cos(turn)),
            at[1] = static_cast<float>(0.5 * r * std::sin(turn)), at[2] = static_cast<float>(0.5 * z);
        } else {
            at[0] = static_cast<float>(random.uniform(-2, 2)),
            at[1] = static_cast<float>(random.uniform(-2, 2)), at[2] = 1.5f;
        }
        for (int axis = 0; axis < 3; ++axis)
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = ball ? -3.2f : -2.8f;
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 4;
        data.sh[row * 3] = ball ? 1.5f : -1.2f;
        data.sh[row * 3 + 1] = ball ? -1.2f : 1.0f;
        data.sh[row * 3 + 2] = -1.2f;
    }
    return GaussianSet(std::move(data));
}

/// Recolours a scene (DC coefficients), by position and by whether a row is the ball.
template <class Colour> GaussianSet with_colours(const GaussianSet& set, const Colour& colour) {
    auto data = set.to_data();
    for (std::size_t row = 0; row < BallRows + WallRows; ++row) {
        const float* at = &data.position[row * 3];
        const Vec3 value = colour(Vec3{at[0], at[1], at[2]}, row < BallRows);
        for (std::size_t c = 0; c < 3; ++c)
            data.sh[row * 3 + c] = static_cast<float>(value[static_cast<int>(c)]);
    }
    return GaussianSet(std::move(data));
}

/// A box around the ball and some of the wall.
CutOutRequest around_ball() {
    CutOutRequest request;
    request.camera = Camera::look_at({0, 0, -3}, {0, 0, 0}, {0, -1, 0}, 0.9, 900, 700);
    const double half = 0.62 * request.camera.fx / 3;  // the ball's outline is at 0.5 / sqrt(8.75)
    const auto cx = request.camera.cx, cy = request.camera.cy;
    for (const auto& [x, y] :
         {std::pair{-1.0, -1.0}, std::pair{1.0, -1.0}, std::pair{1.0, 1.0}, std::pair{-1.0, 1.0}})
        request.area.polygon.push_back(
            {static_cast<float>(cx + x * half), static_cast<float>(cy + y * half)});
    return request;
}

std::size_t count(const std::vector<std::uint8_t>& rows, std::size_t begin, std::size_t end) {
    return static_cast<std::size_t>(std::count(rows.begin() + static_cast<std::ptrdiff_t>(begin),
                                               rows.begin() + static_cast<std::ptrdiff_t>(end),
                                               std::uint8_t{1}));
}

/// Corners of a box around what the rows with value 1 show, with a margin as a hand leaves it.
std::vector<std::array<float, 2>> box_around(const GaussianSet& set, const std::vector<float>& values,
                                             const Camera& camera) {
    Painter painter;
    Image shown;
    painter.rasterizer().forward_values(set.spans(), camera, {}, values, shown);
    float left = 1e9f, top = 1e9f, right = -1, bottom = -1;
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x)
            if (shown.at(x, y, 0) > 0.5f) {
                left = std::min(left, static_cast<float>(x)), right = std::max(right, static_cast<float>(x));
                top = std::min(top, static_cast<float>(y)), bottom = std::max(bottom, static_cast<float>(y));
            }
    const float margin = 0.06f * std::max(right - left, bottom - top);
    left -= margin, top -= margin, right += margin, bottom += margin;
    return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

/// How many pixels each row makes up in a dozen views around the scene.
std::vector<double> seen_from_around(const synth::SynthScene& scene) {
    Painter painter;
    const auto& set = scene.scene.gaussians;
    std::vector<double> inside(set.size()), all(set.size());
    for (int view = 0; view < 12; ++view) {
        const auto camera = synth::scene_camera(scene, view * 0.5236, view % 2 == 0 ? 0.6 : 0.2, 1, 200, 200);
        painter.rasterizer().contributions(set.spans(), camera, {}, Image(200, 200, 1), inside, all);
    }
    return all;
}

class Fails final : public edit::Segmenter {
public:
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>&,
                 const std::optional<edit::BoxPrompt>& box, const Image&) override {
        DOCTEST_CHECK(box.has_value());
        return Mask(image.width, image.height);
    }
    std::string name() const override { return "nothing"; }
};

}  // namespace

DOCTEST_TEST_CASE("sides of a box cut where a thing goes on beyond them, and not where it ends or stands") {
    const edit::BoxPrompt box{20, 20, 60, 60};
    const auto filled = [](int left, int top, int right, int bottom) {
        Mask mask(80, 80);
        for (int y = top; y < bottom; ++y)
            for (int x = left; x < right; ++x) mask.at(x, y) = 1;
        return mask;
    };
    const Mask inside = filled(20, 20, 60, 60);
    const auto text = [&](const Mask& mask, const Mask& level) {
        return sides_text(cut_sides(mask, level, box));
    };
    DOCTEST_CHECK_FALSE(cut_sides(inside, inside, box).any());
    DOCTEST_CHECK(text(inside, filled(20, 0, 60, 60)) == "above");
    DOCTEST_CHECK(text(inside, filled(20, 0, 25, 60)).empty());  // a narrow neck
    DOCTEST_CHECK(text(inside, filled(0, 20, 80, 60)) == "to the left and to the right");
    DOCTEST_CHECK(text(filled(30, 30, 50, 57), filled(0, 0, 80, 80)).empty());
    DOCTEST_CHECK(text(Mask(80, 80), inside).empty());
    const auto standing = cut_sides(inside, filled(20, 20, 60, 80), box);
    DOCTEST_CHECK(standing.below);
    DOCTEST_CHECK(sides_text(standing).empty());
    const Mask all = filled(0, 0, 80, 80);
    DOCTEST_CHECK_FALSE(cut_sides(all, all, {0, 0, 80, 80}).any());  // the picture ends there
}

DOCTEST_TEST_CASE("what a boxed thing stands on is no part of it where it goes on beyond the box") {
    const auto on_disc = [](double radius) {  // the ball on a green disc
        auto data = ball_and_wall().to_data();
        Random random(5);
        for (std::size_t row = BallRows; row < BallRows + WallRows; ++row) {
            const double turn = random.uniform(0, 6.2832), out = radius * std::sqrt(random.uniform(0, 1));
            float* at = &data.position[row * 3];
            at[0] = static_cast<float>(out * std::cos(turn)), at[1] = 0.52f,
            at[2] = static_cast<float>(out * std::sin(turn));
        }
        return GaussianSet(std::move(data));
    };
    const auto labelled = [](const GaussianSet& set, double radius) {  // the ball and the disc so far out
        std::vector<std::uint8_t> bits(set.size(), 0);
        for (std::size_t row = 0; row < set.size(); ++row) {
            const float* at = &set.position()[row * 3];
            bits[row] = row < BallRows || std::hypot(at[0], at[2]) < static_cast<float>(radius) ? 1 : 0;
        }
        return bits;
    };
    Painter painter;
    BoxedView view;
    view.camera = Camera::look_at({0, -1, -3}, {0, 0, 0}, {0, -1, 0}, 0.9, 500, 400);
    view.extent = view.camera.height / view.camera.fy;
    const auto parted = [&](const GaussianSet& set, const std::vector<std::uint8_t>& bits, double half) {
        const double reach = half * view.camera.fx / 3, cx = view.camera.cx, cy = view.camera.cy;
        view.mask = Mask(view.camera.width, view.camera.height);
        for (int y = 0; y < view.mask.height; ++y)
            for (int x = 0; x < view.mask.width; ++x)
                view.mask.at(x, y) = std::abs(x - cx) < reach && std::abs(y - cy) < reach ? 1 : 0;
        const auto& painted = painter.paint(set.spans(), view.camera, {});
        view.picture = {painted.alpha, painted.depth};
        return without_support(set, bits, view, {}, painter);
    };
    const auto table = on_disc(2);
    const auto on_table = parted(table, labelled(table, 0.75), 0.6);
    DOCTEST_CHECK(count(on_table, 0, BallRows) > BallRows * 95 / 100);
    DOCTEST_CHECK(count(on_table, BallRows, table.size()) < 60);
    const auto base = on_disc(0.75);
    DOCTEST_CHECK(parted(base, labelled(base, 1), 1) == labelled(base, 1));  // boxed with what it stands on
}

DOCTEST_TEST_CASE("a box around half of a thing says so") {
    if (!edit::grabcut_available()) return;
    const auto set = ball_and_wall();
    auto request = around_ball();
    DOCTEST_CHECK(cut_text(cut_out(set, request, nullptr)).empty());
    request.area.polygon[0][1] = request.area.polygon[1][1] = static_cast<float>(request.camera.cy);
    const auto half = cut_out(set, request, nullptr);
    DOCTEST_CHECK(half.cut_sides == "above");
    DOCTEST_CHECK(cut_text(half).find("(above)") != std::string::npos);
}

DOCTEST_TEST_CASE("a box around a thing selects all its sides, and not what is behind") {
    if (!edit::grabcut_available()) return;
    const auto set = ball_and_wall();
    const auto request = around_ball();
    const auto rows = cut_out(set, request, nullptr).rows;
    DOCTEST_CHECK(count(rows, 0, BallRows) > BallRows * 95 / 100);
    DOCTEST_CHECK(count(rows, BallRows, rows.size()) < count(rows, 0, BallRows) / 50);  // at the soft outline
    // The box alone would have taken the wall behind and beside the ball, too.
    const auto box = rows_in_area(set, request.camera, request.area);
    DOCTEST_CHECK(count(box, BallRows, box.size()) > WallRows / 20);
}

DOCTEST_TEST_CASE("a thing that other views cannot see still has the side that the box shows") {
    if (!edit::grabcut_available()) return;
    const auto request = around_ball();
    auto data = ball_and_wall().to_data();
    // A narrow white pit around the ball: whoever looks from the side or from above sees its walls only.
    Random random(9);
    const std::size_t walls = 12000, first = data.position.size() / 3;
    data.resize(first + walls);
    for (std::size_t row = first; row < first + walls; ++row) {
        const double turn = random.uniform(0, 6.2832);
        data.position[row * 3] = static_cast<float>(std::cos(turn)),
                            data.position[row * 3 + 1] = static_cast<float>(std::sin(turn));
        data.position[row * 3 + 2] = static_cast<float>(random.uniform(-0.7, 1.5));
        for (int axis = 0; axis < 3; ++axis) data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = -2.8f;
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 4;
        for (int c = 0; c < 3; ++c) data.sh[row * 3 + static_cast<std::size_t>(c)] = 1.5f;
    }
    const auto rows = cut_out(GaussianSet(std::move(data)), request, nullptr).rows;
    DOCTEST_CHECK(count(rows, 0, BallRows) > BallRows / 3);  // nearly half of it faces the camera
    DOCTEST_CHECK(count(rows, BallRows, rows.size()) < count(rows, 0, BallRows) / 10);  // at the soft outline
}

DOCTEST_TEST_CASE("things of all kinds are cut out whole from any side") {
    if (!edit::grabcut_available()) return;
    constexpr int Things = 6;
    // Pooled over the pixels that the rows make up; 0.99 was measured over twelve things.
    constexpr double LeastIou = 0.95;
    double both = 0, any = 0;
    for (int i = 0; i < Things; ++i) {
        Random random(900 + static_cast<std::uint64_t>(i));
        auto spec = synth::random_spec(random, 0);
        spec.seed = 900 + static_cast<std::uint64_t>(i);
        const auto scene = synth::generate(spec);
        const auto& set = scene.scene.gaussians;
        CutOutRequest request;
        request.camera =
            synth::scene_camera(scene, random.uniform(-3.1, 3.1), random.uniform(0.1, 0.5), 1, 1000, 700);
        std::vector<float> thing(set.size());
        for (std::size_t row = 0; row < set.size(); ++row)
            thing[row] = scene.parts[row] == synth::Part::Object ? 1.0f : 0.0f;
        request.area.polygon = box_around(set, thing, request.camera);
        const auto rows = cut_out(set, request, nullptr).rows;
        const auto evidence = seen_from_around(scene);
        for (std::size_t row = 0; row < set.size(); ++row) {
            if (rows[row] != 0 || thing[row] > 0) any += evidence[row];
            if (rows[row] != 0 && thing[row] > 0) both += evidence[row];
        }
    }
    DOCTEST_CHECK(both > LeastIou * any);
}

DOCTEST_TEST_CASE("what is dark before a dark nothing has an outline all the same") {
    if (!edit::grabcut_available()) return;
    const auto set = with_colours(ball_and_wall(), [](const Vec3& at, bool ball) {
        return ball && at[0] > -0.1 ? Vec3{1.5, -1.2, -1.2} : Vec3{-1.7, -1.7, -1.7};
    });
    std::vector<std::uint8_t> ball(set.size(), 0);
    std::fill_n(ball.begin(), BallRows, std::uint8_t{1});
    const auto rows = cut_out(set.filtered(ball), around_ball(), nullptr).rows;
    DOCTEST_CHECK(count(rows, 0, BallRows) == BallRows);  // no crumbs are left: they would hang on nothing
}

DOCTEST_TEST_CASE(
    "a panel that looks like what is behind is the thing's, and what is seen through a hole is not") {
    if (!edit::grabcut_available()) return;
    const auto dark = [](const Vec3& at, bool ball) {
        return ball && !(std::hypot(at[0], at[1]) < 0.22 && at[2] < 0) ? Vec3{1.5, -1.2, -1.2}
                                                                       : Vec3{-1.2, -1.2, -1.2};
    };
    const auto rows = cut_out(with_colours(ball_and_wall(), dark), around_ball(), nullptr).rows;
    DOCTEST_CHECK(count(rows, 0, BallRows) > BallRows * 95 / 100);
    DOCTEST_CHECK(count(rows, BallRows, rows.size()) < count(rows, 0, BallRows) / 50);
    auto data = ball_and_wall().to_data();
    for (std::size_t row = 0; row < BallRows; ++row) {  // the ball as a ring
        float* at = &data.position[row * 3];
        const float radius = std::max(1e-6f, std::hypot(at[0], at[1]));
        const float to = (0.42f + 0.16f * (radius - 0.25f)) / radius;
        at[0] *= to, at[1] *= to, at[2] *= 0.15f;
    }
    const auto ring = cut_out(GaussianSet(std::move(data)), around_ball(), nullptr).rows;
    DOCTEST_CHECK(count(ring, 0, BallRows) > BallRows * 95 / 100);
    DOCTEST_CHECK(count(ring, BallRows, ring.size()) < count(ring, 0, BallRows) / 50);
}

DOCTEST_TEST_CASE("holes are closed where it is possible, and not what the picture's rim opens") {
    Mask mask(7, 5), possible(7, 5);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x)
            mask.at(x, y) = x == 0 || x == 3 || x == 6 || y == 0 || (y == 4 && x < 4) ? 1 : 0;
    std::fill(possible.data.begin(), possible.data.end(), std::uint8_t{1});
    possible.at(1, 2) = 0;
    auto closed = mask;
    close_holes(closed, possible);
    DOCTEST_CHECK(closed.at(1, 1) == 1);
    DOCTEST_CHECK(closed.at(2, 3) == 1);
    DOCTEST_CHECK(closed.at(1, 2) == 0);  // something else is seen there
    DOCTEST_CHECK(closed.at(5, 2) == 0);  // open below
    DOCTEST_CHECK(closed.count() == mask.count() + 5);
}

DOCTEST_TEST_CASE("where nothing is cut out the box counts, and a box of nothing selects nothing") {
    const auto set = ball_and_wall();
    auto request = around_ball();
    Fails fails;
    const auto rows = cut_out(set, request, &fails).rows;
    const auto box = rows_in_area(set, request.camera, request.area);
    DOCTEST_CHECK(count(rows, 0, BallRows) > 0);
    for (std::size_t row = 0; row < BallRows; ++row)
        if (box[row] == 0) DOCTEST_CHECK(rows[row] == 0);
    request.area.polygon = {{10, 10}, {10, 10}, {10, 10}};
    DOCTEST_CHECK(cut_out(set, request, nullptr).rows == std::vector<std::uint8_t>(set.size(), 0));
    request.area.polygon.clear();
    DOCTEST_CHECK(cut_out(set, request, nullptr).rows == std::vector<std::uint8_t>(set.size(), 0));
}

DOCTEST_TEST_CASE("cutting out stops when it is told to") {
    std::stop_source source;
    source.request_stop();
    JobControl control;
    control.stop = source.get_token();
    DOCTEST_CHECK_THROWS_WITH_AS(cut_out(ball_and_wall(), around_ball(), nullptr, control),
                                 doctest::Contains("stopped"), Error);
}

DOCTEST_TEST_CASE(
    "a box in words is the one in the picture that the render command makes, and anything else is said to be "
    "none") {
    Scene scene;
    scene.gaussians = ball_and_wall();
    const auto plain = cut_out_request("0.25,0.1,0.75,0.9", scene, "auto");
    const auto looked = choose_camera(scene, {}, RenderParameters{});
    DOCTEST_CHECK(plain.camera.width == looked.width);
    DOCTEST_CHECK(length(plain.camera.centre() - looked.centre()) == 0);
    DOCTEST_REQUIRE(plain.area.polygon.size() == 4);
    DOCTEST_CHECK(plain.area.polygon[2][0] == doctest::Approx(0.75 * looked.width));
    DOCTEST_CHECK(plain.area.polygon[2][1] == doctest::Approx(0.9 * looked.height));
    RenderParameters other;
    other.azimuth = 180, other.elevation = 20, other.zoom = 2;
    const auto turned = cut_out_request("0.25,0.1,0.75,0.9,180,20,2", scene, "auto");
    DOCTEST_CHECK(length(turned.camera.centre() - choose_camera(scene, {}, other).centre()) == 0);
    for (const char* wrong : {"", "1", "a,b,c,d", "0.1,0.2,0.3", "0.1,0.2,0.3,0.4,", "0.1,0.2,0.3,0.4,5",
                              "nan,0,1,1", "0,0,1,inf", "0.5,0,0.4,1", "-0.1,0,1,1", "0,0,1,1.1",
                              "0,0,1,1,0,95,1", "0,0,1,1,0,0,0", "0 0 1 1"})
        DOCTEST_CHECK_THROWS_AS(cut_out_request(wrong, scene, "auto"), Error);
}

}  // namespace cut_out_test
