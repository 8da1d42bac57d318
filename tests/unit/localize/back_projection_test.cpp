// Masks of a two-object scene come back as the labels they were rendered from.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/localize/back_projection.h"

namespace back_projection_test {

namespace {

using namespace gse;

constexpr double LeastIou = 0.95;  // given true masks; what is lost are rows hidden in every view

struct TwoBalls {
    GaussianSet set;
    std::vector<std::uint8_t> first;  // [N] rows of the first ball
};

/// Two opaque balls beside each other, 250 surface splats each.
TwoBalls two_balls() {
    TwoBalls scene;
    GaussianData data;
    constexpr std::size_t count = 250;
    data.resize(2 * count);
    Random random(7);
    for (std::size_t row = 0; row < 2 * count; ++row) {
        const bool first = row < count;
        const double y = 1 - 2 * (static_cast<double>(row % count) + 0.5) / count,
                     angle = 2.399963 * static_cast<double>(row);
        const double r = std::sqrt(1 - y * y);
        const Vec3 p =
            Vec3{first ? -0.6 : 0.6, 0, 0} + Vec3{r * std::cos(angle), y, r * std::sin(angle)} * 0.45;
        for (int axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(p[axis]);
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(std::log(0.05));
            data.sh[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(random.uniform(-1, 1));
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 3;
        scene.first.push_back(first ? 1 : 0);
    }
    scene.set = GaussianSet(std::move(data));
    return scene;
}

std::vector<View> ring(int count) {
    OrbitParameters orbit;
    orbit.radius = 3.5;
    return orbit_views(orbit, count, 48, 48);
}

/// Masks of the first ball, from its share of every pixel.
std::vector<localize::MaskedView> true_views(const TwoBalls& scene, raster::Rasterizer& rasterizer,
                                             int count) {
    std::vector<localize::MaskedView> views;
    const std::vector<float> values(scene.first.begin(), scene.first.end());
    for (const auto& view : ring(count)) {
        Image seen;
        rasterizer.forward_values(scene.set.spans(), view.camera, {}, values, seen);
        for (auto& value : seen.data) value = value > 0.5f ? 1.0f : 0.0f;
        views.push_back({view.camera, seen, false});
    }
    return views;
}

double iou(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    int both = 0, either = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += a[i] != 0 && b[i] != 0 ? 1 : 0;
        either += a[i] != 0 || b[i] != 0 ? 1 : 0;
    }
    return static_cast<double>(both) / either;
}

/// Counts what it is asked for.
class Counting final : public raster::Rasterizer {
public:
    explicit Counting(raster::Rasterizer& whole) : whole_(whole) {}
    void forward(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                 raster::ForwardOutput& output) override {
        whole_.forward(rows, camera, settings, output);
    }
    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  raster::Gradients& output) override {
        whole_.backward(d_colour, d_alpha, first_row, output);
    }
    void contributions(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        ++rendered;
        whole_.contributions(rows, camera, settings, mask, masked, total);
    }
    void forward_values(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                        std::span<const float> values, Image& output) override {
        whole_.forward_values(rows, camera, settings, values, output);
    }
    std::string name() const override { return whole_.name(); }

    int rendered = 0;

private:
    raster::Rasterizer& whole_;
};

}  // namespace

DOCTEST_TEST_CASE(
    "of a view that votes again as before nothing is rendered, and the weights are the same to the last "
    "bit") {
    const auto scene = two_balls();
    ThreadPool pool(2);
    const auto fast = raster::make_fast_rasterizer(pool);
    for (const std::size_t room : {localize::VoteCache::MostBytes, std::size_t{40000}, std::size_t{0}}) {
        DOCTEST_CAPTURE(room);
        auto views = true_views(scene, *fast, 8);
        Counting counting(*fast);
        localize::VoteCache votes(room);
        const auto check = [&](int most) {
            counting.rendered = 0;
            const auto found = votes.back_project(scene.set.spans(), views, {}, counting);
            const auto expected = localize::back_project(scene.set.spans(), views, {}, *fast);
            DOCTEST_CHECK(found.probability == expected.probability);
            DOCTEST_CHECK(found.coverage == expected.coverage);
            DOCTEST_CHECK(found.views_used == expected.views_used);
            if (room == localize::VoteCache::MostBytes) DOCTEST_CHECK(counting.rendered == most);
            if (room == 0) DOCTEST_CHECK(counting.rendered == expected.views_used);
        };
        check(8);
        check(0);
        for (const std::size_t v : {2u, 5u}) std::fill_n(views[v].mask.data.begin(), 700, 1.0f);
        check(2);
        views[3].failed = true;
        check(0);
        std::swap(views[0], views[7]);  // another order of the sum, of the same votes
        check(0);
        views[0].camera.cx += 0.25;
        views.erase(views.begin() + 4);
        check(1);
        check(0);
    }
}

DOCTEST_TEST_CASE("true masks give true labels") {
    const auto scene = two_balls();
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto views = true_views(scene, *rasterizer, 12);
    const auto field = localize::back_project(scene.set.spans(), views, {}, *rasterizer);
    DOCTEST_CHECK(field.views_used == 12);
    const auto label = localize::bits(field, 0.5, 0.2);
    DOCTEST_CHECK(iou(label, scene.first) > LeastIou);
    for (const float share : field.probability) DOCTEST_CHECK((share >= 0 && share <= 1));
}

DOCTEST_TEST_CASE("failed views do not vote, and too many of them end the search") {
    const auto scene = two_balls();
    const auto rasterizer = raster::make_plain_rasterizer();
    auto views = true_views(scene, *rasterizer, 8);
    const auto good = localize::back_project(scene.set.spans(), {views.data(), 5}, {}, *rasterizer);
    for (std::size_t v = 5; v < 8; ++v) {
        views[v].failed = true;
        std::fill(views[v].mask.data.begin(), views[v].mask.data.end(), 0.0f);
    }
    const auto some = localize::back_project(scene.set.spans(), views, {}, *rasterizer);
    DOCTEST_CHECK(some.views_used == 5);
    DOCTEST_CHECK(some.probability == good.probability);
    DOCTEST_CHECK(some.coverage == good.coverage);
    for (std::size_t v = 3; v < 5; ++v) views[v].failed = true;
    DOCTEST_CHECK_THROWS_AS(localize::back_project(scene.set.spans(), views, {}, *rasterizer), Error);
    DOCTEST_CHECK_THROWS_AS(localize::back_project(scene.set.spans(), {}, {}, *rasterizer), Error);
}

DOCTEST_TEST_CASE("the weights are the colour gradient of the masked picture (S5)") {
    // sum over pixels of alpha T M is the gradient of sum(M * colour) by a colour that all directions share.
    const auto scene = two_balls();
    const auto rasterizer = raster::make_plain_rasterizer();
    const auto views = true_views(scene, *rasterizer, 1);
    const auto field = localize::back_project(scene.set.spans(), views, {}, *rasterizer);
    raster::Settings settings;
    settings.negative_colour_slope = 1;  // every row's colour counts, also those clamped at zero
    raster::ForwardOutput output;
    rasterizer->forward(scene.set.spans(), views[0].camera, settings, output);
    Image d_colour(48, 48, 3);
    for (std::size_t i = 0; i < views[0].mask.data.size(); ++i)
        d_colour.data[i * 3 + 1] = views[0].mask.data[i];
    raster::Gradients gradients;
    rasterizer->backward(d_colour, {}, 0, gradients);
    constexpr double FloatGradient = 1e-4;  // gradients are handed out as float
    for (std::size_t row = 0; row < scene.set.size(); ++row) {
        const double masked = field.probability[row] * std::max(field.coverage[row], 1e-8);
        DOCTEST_CHECK(gradients.sh[row * 3 + 1] / ShC0 ==
                      doctest::Approx(masked).epsilon(FloatGradient).scale(1));
    }
}

DOCTEST_TEST_CASE("rows nobody sees are not labelled") {
    LabelField field;
    field.probability = {1, 1, 0.5f, 0.6f};
    field.coverage = {0.1, 3, 3, 3};
    const auto label = localize::bits(field, 0.5, 0.5);
    DOCTEST_CHECK(label == std::vector<std::uint8_t>{0, 1, 0, 1});
}

}  // namespace back_projection_test
