// The ground that a model is shown instead of a scene.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "engine/edit/placement/ground_cover.h"
#include "engine/edit/target_views/strategies/studio_background.h"

namespace plain_ground_test {

namespace {

using namespace gse;
using namespace gse::edit;

const Vec3 Up{0, -1, 0};

UprightBounds figure() { return {{0.5, 1, 2}, 1.0, 0.5, 0.4}; }

StudioBackground ground_of(const std::string& sentence) {
    return *plain_ground(sentence, figure(), Up, ModelTraits{});
}

/// Pixel in which the camera sees a point of the world.
std::pair<int, int> pixel_of(const Camera& camera, const Vec3& point) {
    const Vec3 at = camera.to_camera(point);
    return {static_cast<int>(std::floor(camera.fx * at.x / at.z + camera.cx)),
            static_cast<int>(std::floor(camera.fy * at.y / at.z + camera.cy))};
}

/// Keeps what it was shown; answers with outlines or without.
class Recorder final : public MultiViewEditor {
public:
    explicit Recorder(bool outlines, bool supports_appearance_editing = false)
        : outlines_(outlines), restyles_(supports_appearance_editing) {}
    EditedViews edit(const std::vector<EditView>& views, const EditViewsRequest&,
                     const JobControl&) override {
        shown.push_back(views);
        EditedViews targets;
        for (const auto& view : views) {
            targets.images.push_back(view.rendered);
            if (outlines_) targets.outlines.emplace_back(view.rendered.width, view.rendered.height, 1);
            if (outlines_ && covers > 0)
                for (auto& share : targets.outlines.back().data) share = covers;
        }
        return targets;
    }
    bool supports_appearance_editing() const override { return restyles_; }
    std::vector<std::vector<EditView>> shown;
    float covers = 0;  // of every pixel, what it tells

private:
    bool outlines_, restyles_;
};

EditView red_view() {
    EditView view;
    view.view.camera = Camera::look_at({0.5, 0, -2}, {0.5, 0.7, 2}, Up, 0.8, 32, 24);
    view.rendered = Image(32, 24, 3);
    for (std::size_t i = 0; i < view.rendered.data.size(); i += 3) view.rendered.data[i] = 1;
    view.original = view.clean_plate.picture = view.rendered;
    view.mask = Mask(32, 24);
    view.mask.at(16, 12) = 1;
    return view;
}

}  // namespace

DOCTEST_TEST_CASE(
    "the plain ground lies where the thing stands, three figures wide to every side, in the colour that the "
    "sentence names") {
    const auto plain = ground_of("a red cat on the grass");
    const auto camera = Camera::look_at({0.5, -3, -6}, {0.5, 1, 2}, Up, 0.9, 200, 160);
    const auto picture = picture_of(plain, camera);
    const auto green_at = [&](const Vec3& offset) {
        const auto [x, y] = pixel_of(camera, plain.standing.foot + offset);
        return picture.at(x, y, 1);
    };
    DOCTEST_CHECK(green_at({0, 0, 0}) == doctest::Approx(plain.ground[1]));
    for (const double side : {-1.0, 1.0}) {
        DOCTEST_CHECK(green_at({side * 2.9, 0, 0}) == doctest::Approx(plain.ground[1]));
        DOCTEST_CHECK(green_at({side * 3.1, 0, 0}) == doctest::Approx(plain.sky[1]));
    }
    DOCTEST_CHECK(picture.at(100, 1, 2) == doctest::Approx(plain.sky[2]));
    DOCTEST_CHECK(ground_of("a red cat").ground != plain.ground);
    DOCTEST_CHECK(ground_of("a red cat on the snow").ground != ground_of("a red cat").ground);
    const auto below = Camera::look_at({0.5, 3, -6}, {0.5, 1, 2}, Up, 0.9, 40,
                                       40);  // seen from under it, there is no more than that
    for (const float value : picture_of(plain, below).data) DOCTEST_CHECK(std::isfinite(value));
}

DOCTEST_TEST_CASE("what is as flat as a ground, or is not there, stands on none") {
    auto flat = figure();
    flat.height = 0.02;
    DOCTEST_CHECK_FALSE(plain_ground("snow", flat, Up, ModelTraits{}).has_value());
    DOCTEST_CHECK_FALSE(plain_ground("a cat", UprightBounds{}, Up, ModelTraits{}).has_value());
}

DOCTEST_TEST_CASE("only rounds that begin a new thing, and restyles, are shown the plain ground") {
    const auto view = red_view();
    const JobControl job;
    const auto asked = [&](Recorder& model, const EditViewsRequest& input) {
        OnPlainGround on_ground(model, ground_of("a red cat"), BeforePlain::Nothing);
        on_ground.edit({view}, input, job);
    };
    EditViewsRequest anew;
    anew.anew = true;
    Recorder tells(true);
    asked(tells, anew);
    DOCTEST_REQUIRE(tells.shown.size() == 1);
    const auto& shown = tells.shown[0][0];
    DOCTEST_CHECK(shown.rendered.data == picture_of(ground_of("a red cat"), view.view.camera).data);
    DOCTEST_CHECK(shown.original.data == shown.rendered.data);
    DOCTEST_CHECK(shown.clean_plate.picture.data == shown.rendered.data);
    Recorder silent(false);  // its pictures could not be cut out: the scene after all
    asked(silent, anew);
    DOCTEST_REQUIRE(silent.shown.size() == 2);
    DOCTEST_CHECK(silent.shown[1][0].rendered.data == view.rendered.data);
    anew.round = 1;
    Recorder later(true);
    asked(later, anew);
    DOCTEST_CHECK(later.shown[0][0].rendered.data == view.rendered.data);
    Recorder plain(false), supports_appearance_editing(false, true);
    asked(plain, {});
    DOCTEST_CHECK(plain.shown[0][0].rendered.data == view.rendered.data);
    asked(supports_appearance_editing, {});
    const auto& styled = supports_appearance_editing.shown[0][0];
    DOCTEST_CHECK(styled.rendered.at(16, 12, 0) == 1);  // what may change is shown as it is
    DOCTEST_CHECK(styled.rendered.at(15, 12, 0) != 1);
}

DOCTEST_TEST_CASE(
    "what is drawn on the plain ground is moved before the scene, as far as it is seen through") {
    auto view = red_view();
    EditViewsRequest anew;
    anew.anew = true;
    for (const float covers : {0.0f, 0.25f, 1.0f}) {
        Recorder model(true);  // draws what it was shown: nothing of its own
        model.covers = covers;
        OnPlainGround on_ground(model, ground_of("a red cat"), BeforePlain::Nothing);
        const auto drawn = on_ground.edit({view}, anew, JobControl{});
        const auto& shown = model.shown[0][0].rendered;
        for (std::size_t i = 0; i < shown.data.size(); ++i)
            DOCTEST_REQUIRE(drawn.images[0].data[i] ==
                            doctest::Approx(covers * shown.data[i] + (1 - covers) * view.rendered.data[i]));
    }
}

DOCTEST_TEST_CASE("to what something is added the plain ground is shown only where the scene has nothing") {
    auto view = red_view();
    view.clean_plate.depth = Image(32, 24, 1);
    view.clean_plate.depth.at(16, 12, 0) = 4;
    EditViewsRequest anew;
    anew.anew = true;
    Recorder model(true);
    OnPlainGround on_ground(model, ground_of("a man wearing a hat"), BeforePlain::Scene);
    on_ground.edit({view}, anew, JobControl{});
    const auto plain = picture_of(ground_of("a man wearing a hat"), view.view.camera);
    const auto& shown = model.shown[0][0];
    for (int c = 0; c < 3; ++c) {
        DOCTEST_CHECK(shown.rendered.at(16, 12, c) == view.rendered.at(16, 12, c));
        DOCTEST_CHECK(shown.rendered.at(15, 12, c) == plain.at(15, 12, c));
    }
    DOCTEST_CHECK(shown.clean_plate.picture.data == shown.rendered.data);
}

namespace {

/// A column of the label, a metre high, and other splats at `ground` metres of height in a square around it.
struct Column {
    GaussianSet set;
    std::vector<std::uint8_t> bits;
};

Column column_on(double half_side, double height) {
    GaussianData data;
    std::vector<std::uint8_t> bits;
    const auto add = [&](const Vec3& at, std::uint8_t label) {
        const auto row = data.size();
        data.resize(row + 1);
        for (int axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(at[axis]);
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = std::log(0.06f);
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 6;
        bits.push_back(label);
    };
    for (int i = 0; i <= 20; ++i)
        for (int k = 0; k < 4; ++k) add({0.1 * (k % 2), -0.05 * i, 0.1 * (k / 2)}, 1);
    for (double x = -half_side; x <= half_side; x += 0.08)
        for (double z = -half_side; z <= half_side; z += 0.08) add({x, -height, z}, 0);
    return {GaussianSet(std::move(data)), std::move(bits)};
}

}  // namespace

DOCTEST_TEST_CASE("how much ground there is around a thing is seen from above: all, a plinth, none") {
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto cover = [&](const Column& column) {
        const auto standing = standing_of(column.set, column.bits, Up, {0, 0, -1});
        return ground_cover(column.set, column.bits, standing, Up, *rasterizer);
    };
    const auto in_nothing = [&](const Column& column) {
        return ground_under("a cat", column.set, column.bits, Up, {0, 0, -1}, *rasterizer, ModelTraits{})
            ->in_nothing;
    };
    const auto field = column_on(1.6, 0), plinth = column_on(0.3, 0), bare = column_on(-1, 0),
               roof = column_on(1.6, 0.8), below = column_on(1.6, -1.5);
    DOCTEST_CHECK(cover(field) > 0.95);
    DOCTEST_CHECK_FALSE(in_nothing(field));
    DOCTEST_CHECK(cover(plinth) > 0);
    DOCTEST_CHECK(in_nothing(plinth));
    DOCTEST_CHECK(cover(bare) == 0);
    DOCTEST_CHECK(in_nothing(bare));
    DOCTEST_CHECK(cover(roof) == 0);     // over its head is no ground
    DOCTEST_CHECK(cover(below) > 0.95);  // it is worn, or held
    const std::vector<std::uint8_t> other(3, 1);
    DOCTEST_CHECK_FALSE(
        ground_under("a cat", field.set, other, Up, {0, 0, -1}, *rasterizer, ModelTraits{}).has_value());
}

DOCTEST_TEST_CASE("a scene has a ground where that reaches out from under what rises out of it") {
    const auto rasterizer = raster::make_plain_rasterizer();
    OrbitParameters orbit;
    orbit.centre = {0, -0.5, 0};
    orbit.radius = 4;
    const auto views = orbit_views(orbit, 6, 32, 32);
    const auto below = [&](const Column& column) {
        return ground_below("a cat", column.set, views, Up, *rasterizer, ModelTraits{});
    };
    DOCTEST_CHECK_FALSE(below(column_on(1.6, 0)).has_value());
    const auto bare = below(column_on(-1, 0)), plinth = below(column_on(0.3, 0));
    DOCTEST_REQUIRE(bare.has_value());
    DOCTEST_CHECK(plinth.has_value());
    DOCTEST_CHECK(std::abs(dot(bare->standing.foot, Up)) < 0.1);  // the lowest of it
    DOCTEST_CHECK_FALSE(
        ground_below("a cat", GaussianSet(), views, Up, *rasterizer, ModelTraits{}).has_value());
    orbit.radius = 0.3;  // so near that hardly anything else is seen
    DOCTEST_CHECK_FALSE(ground_below("a cat", column_on(-1, 0).set, orbit_views(orbit, 6, 32, 32), Up,
                                     *rasterizer, ModelTraits{})
                            .has_value());
}

DOCTEST_TEST_CASE("a picture is moved before the plain ground by what it covers of its background") {
    const auto plain = ground_of("a red cat on the grass");
    const auto camera = Camera::look_at({0.5, 0, -2}, {0.5, 0.7, 2}, Up, 0.8, 32, 24);
    const std::array<float, 3> background{1, 1, 1};
    const std::array<float, 3> red{0.8f, 0.1f, 0.2f};
    const Image behind = picture_of(plain, camera);
    for (const float alpha : {0.0f, 0.25f, 1.0f}) {
        Image picture(32, 24, 3), covered(32, 24, 1, alpha);
        for (std::size_t i = 0; i < picture.data.size(); ++i)
            picture.data[i] = alpha * red[i % 3] + (1 - alpha) * background[i % 3];
        const Image shown = before_plain(plain, camera, picture, covered, background);
        for (std::size_t i = 0; i < shown.data.size(); ++i)
            DOCTEST_CHECK(shown.data[i] ==
                          doctest::Approx(alpha * red[i % 3] + (1 - alpha) * behind.data[i]));
    }
}

}  // namespace plain_ground_test
