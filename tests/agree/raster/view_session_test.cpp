// A view session against rendering in full. Bit-identical while the rows of an edit move, split, go and are
// labelled anew, for every budget; near to the plain double version.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/raster/view_session.h"
#include "tests/agree/raster/scenes.h"

namespace view_session_test {

using namespace gse;
using namespace gse::raster;

namespace {

// As in fast_plain_test.cpp.
constexpr double ImageTolerance = 1e-5;
constexpr double GradientTolerance = 1e-4;
constexpr std::size_t Ample = 256 << 20;

/// Rows that stay, and behind them rows that change.
struct Rows {
    GaussianData data;
    std::size_t first = 0;
};

/// The `count` rows nearest to the first one go behind the others: an edit's rows lie together.
Rows with_compact_tail(const GaussianData& data, std::size_t count) {
    std::vector<std::size_t> order(data.size());
    for (std::size_t row = 0; row < order.size(); ++row) order[row] = row;
    const auto distance = [&](std::size_t row) {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double d =
                static_cast<double>(data.position[row * 3 + axis]) - static_cast<double>(data.position[axis]);
            sum += d * d;
        }
        return std::isfinite(sum) ? sum : 0.0;  // rows that cannot be drawn are labelled too
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return distance(a) > distance(b); });
    Rows rows;
    rows.data.sh_degree = data.sh_degree;
    for (const std::size_t row : order) rows.data.append_row(data, row);
    rows.first = data.size() - count;
    return rows;
}

void jitter(Rows& rows, Random& random, double size) {
    const auto move = [&](std::vector<float>& values, std::size_t stride, double step) {
        for (std::size_t i = rows.first * stride; i < values.size(); ++i)
            values[i] += static_cast<float>(step * random.normal());
    };
    move(rows.data.position, 3, size);
    move(rows.data.log_scale, 3, size);
    move(rows.data.rotation, 4, size);
    move(rows.data.opacity_logit, 1, size);
    move(rows.data.sh, rows.data.sh_stride(), size);
}

/// Appends copies of some of the changing rows, one of them exactly as deep as a row that stays.
void densify(Rows& rows) {
    const GaussianData before = rows.data;
    for (std::size_t row = rows.first; row < before.size(); row += 3) rows.data.append_row(before, row);
    rows.data.append_row(before, rows.first / 2);
}

/// Drops every fourth of the changing rows.
void prune(Rows& rows) {
    GaussianData kept;
    kept.sh_degree = rows.data.sh_degree;
    for (std::size_t row = 0; row < rows.data.size(); ++row)
        if (row < rows.first || row % 4 != 1) kept.append_row(rows.data, row);
    rows.data = std::move(kept);
}

struct Pictures {
    ForwardOutput image;
    Gradients gradients;
};

bool same_picture(const ForwardOutput& a, const ForwardOutput& b) {
    return a.colour.data == b.colour.data && a.alpha.data == b.alpha.data && a.depth.data == b.depth.data &&
           a.blended == b.blended && a.dropped_rows == b.dropped_rows;
}

/// Two views of the scene by both ways, compared; the views' pictures leave traces in the memory of both.
class Comparison {
public:
    Comparison(Rasterizer& rasterizer, std::size_t budget)
        : rasterizer_(rasterizer), session_(rasterizer.view_session(2, budget)) {}

    ViewSession& session() { return *session_; }
    Camera cameras[2] = {test::test_camera(150, 110), test::test_camera(83, 97, 3.1)};
    Settings settings;

    void check(const Rows& rows) {
        for (std::size_t view = 0; view < 2; ++view) {
            const Camera& camera = cameras[view];
            const Image d_colour = test::noise_image(camera.width, camera.height, 3, 31);
            const Image d_alpha = view == 0 ? Image{} : test::noise_image(camera.width, camera.height, 1, 32);
            session_->forward(view, spans(rows.data), rows.first, camera, settings, found_.image);
            session_->backward(d_colour, d_alpha, found_.gradients);
            rasterizer_.forward(spans(rows.data), camera, settings, expected_.image);
            rasterizer_.backward(d_colour, d_alpha, rows.first, expected_.gradients);
            DOCTEST_CAPTURE(view);
            DOCTEST_CHECK(same_picture(found_.image, expected_.image));
            DOCTEST_CHECK(test::identical(found_.gradients, expected_.gradients));
            DOCTEST_CHECK(found_.image.pairs <= expected_.image.pairs);
        }
    }

private:
    Rasterizer& rasterizer_;
    std::unique_ptr<ViewSession> session_;
    Pictures found_, expected_;
};

/// Puts the rows of an edit through all changes, one after the other.
void live_through(Comparison& comparison, Rows rows, std::uint64_t seed) {
    Random random(seed);
    comparison.check(rows);
    for (const double size : {0.0, 1e-4, 0.01, 0.1}) {
        jitter(rows, random, size);
        comparison.check(rows);
    }
    densify(rows);
    comparison.check(rows);
    jitter(rows, random, 0.3);
    prune(rows);
    comparison.check(rows);
    rows.data.resize(rows.first);  // none is left
    comparison.check(rows);
}

}  // namespace

DOCTEST_TEST_CASE(
    "a view session gives the bits of rendering in full, for every instruction set, thread count and "
    "budget") {
    for (const std::string& kernels : raster::usable_kernels())
        for (const unsigned threads : {1u, 2u})
            for (const std::size_t budget : {std::size_t{0}, std::size_t{600 << 10}, Ample}) {
                DOCTEST_CAPTURE(kernels);
                DOCTEST_CAPTURE(threads);
                DOCTEST_CAPTURE(budget);
                ThreadPool pool(threads);
                const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
                Comparison comparison(*rasterizer, budget);
                const Rows rows = with_compact_tail(
                    test::random_scene({.count = 5000, .seed = 81, .log_scale = -3.6}), 400);
                live_through(comparison, rows, 82);
                const ViewSessionWork work = comparison.session().work();
                DOCTEST_CHECK(work.kept_bytes <= budget);
                DOCTEST_CHECK((work.continued > 0) == (budget > 0));
                DOCTEST_CHECK((work.full > 0) == (budget < Ample));
            }
}

DOCTEST_TEST_CASE("a view session follows another label, other cameras and other settings") {
    ThreadPool pool(2);
    const auto rasterizer = make_fast_rasterizer(pool);
    Comparison comparison(*rasterizer, Ample);
    const GaussianData data = test::random_scene({.count = 3000, .seed = 83, .log_scale = -3.4});
    Rows rows = with_compact_tail(data, 200);
    comparison.check(rows);
    DOCTEST_CHECK(comparison.session().work().prepared == 2);
    rows = with_compact_tail(data, 350);  // seen by itself: there are others that stay
    comparison.check(rows);
    DOCTEST_CHECK(comparison.session().work().prepared == 4);
    GaussianData turned = data;  // as many rows as before, but others
    std::reverse(turned.opacity_logit.begin(), turned.opacity_logit.end());
    rows = with_compact_tail(turned, 350);
    comparison.session().forget();
    DOCTEST_CHECK(comparison.session().work().kept_bytes == 0);
    comparison.check(rows);
    comparison.cameras[0] = test::test_camera(150, 110, 3.7);
    comparison.check(rows);
    comparison.cameras[1] = test::test_camera(64, 64);
    comparison.check(rows);
    const std::size_t prepared = comparison.session().work().prepared;
    DOCTEST_CHECK(prepared == 8);
    comparison.check(rows);
    DOCTEST_CHECK(comparison.session().work().prepared == prepared);
    Settings& settings = comparison.settings;
    settings.background = {0.2f, 0.5f, 0.9f};
    comparison.check(rows);
    settings.antialiased = true;
    settings.negative_colour_slope = 0.5f;
    comparison.check(rows);
    settings.sh_degree = 1;
    settings.blur_px2 = 0.1f;
    comparison.check(rows);
    DOCTEST_CHECK(comparison.session().work().full == 0);
}

DOCTEST_TEST_CASE("a view session follows the near plane, given or fitted to rows that change") {
    ThreadPool pool(2);
    const auto rasterizer = make_fast_rasterizer(pool);
    const GaussianData data = test::random_scene({.count = 3000, .seed = 84, .log_scale = -3.6});
    Rows rows = with_compact_tail(data, 300);
    Comparison given(*rasterizer, Ample);
    for (const float near : {0.2f, 0.25f, 2.9f, 2.95f, 4.0f, 0.2f}) {  // some inside of the scene
        DOCTEST_CAPTURE(near);
        given.settings.near_plane = near;
        given.settings.far_plane = 20 * near;
        given.check(rows);
    }
    // Cameras inside the scene, and rows before them: the fitted plane moves with every step, among rows that
    // stay.
    Comparison fitted(*rasterizer, Ample);
    for (Camera& camera : fitted.cameras) camera = test::test_camera(90, 70, 0.7);
    Random random(85);
    for (int step = 0; step < 12; ++step) {
        DOCTEST_CAPTURE(step);
        jitter(rows, random, 0.08);
        fitted.check(rows);
    }
    DOCTEST_CHECK(fitted.session().work().continued > 0);
}

DOCTEST_TEST_CASE("a view session counts rows that cannot be drawn, before and behind the near plane") {
    ThreadPool pool(1);
    const auto rasterizer = make_fast_rasterizer(pool);
    GaussianData data = test::random_scene({.count = 1200, .seed = 86, .log_scale = -3.0});
    for (std::size_t row = 40; row < data.size(); row += 90) data.position[row * 3] = NAN;
    for (std::size_t row = 70; row < data.size(); row += 90) data.sh[row * data.sh_stride()] = INFINITY;
    for (std::size_t row = 80; row < data.size(); row += 90) data.opacity_logit[row] = INFINITY;
    Rows rows = with_compact_tail(data, 150);
    Comparison comparison(*rasterizer, Ample);
    Random random(87);
    for (const float near : {0.2f, 0.3f, 3.0f, 3.1f}) {
        comparison.settings.near_plane = near;
        jitter(rows, random, 0.01);
        comparison.check(rows);
    }
}

DOCTEST_TEST_CASE(
    "a row that changes may come to reach the whole picture, and one as deep as a fixed row lies behind it") {
    ThreadPool pool(2);
    for (const std::string& kernels : raster::usable_kernels()) {
        DOCTEST_CAPTURE(kernels);
        const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
        Rows rows = with_compact_tail(
            test::random_scene({.count = 2000, .seed = 88, .log_scale = -3.6, .opacity = 3}), 60);
        Comparison comparison(*rasterizer, Ample);
        comparison.check(rows);
        for (std::size_t i = rows.first; i < rows.data.size(); ++i) {  // twins of fixed rows: ties in depth
            const std::size_t twin = (i - rows.first) * 7;
            std::copy_n(rows.data.position.begin() + static_cast<std::ptrdiff_t>(twin * 3), 3,
                        rows.data.position.begin() + static_cast<std::ptrdiff_t>(i * 3));
        }
        comparison.check(rows);
        for (std::size_t step = 1; step <= 4; ++step) {
            for (std::size_t axis = 0; axis < 3; ++axis) rows.data.log_scale[rows.first * 3 + axis] += 1.0f;
            comparison.check(rows);
        }
    }
}

DOCTEST_TEST_CASE("a view session agrees with the plain version rendered in full") {
    ThreadPool pool(2);
    const auto plain = make_plain_rasterizer();
    for (const std::string& kernels : raster::usable_kernels()) {
        DOCTEST_CAPTURE(kernels);
        const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
        Rows rows = with_compact_tail(test::random_scene({.count = 700, .seed = 89}), 80);
        const Camera camera = test::test_camera(96, 64);
        const auto session = rasterizer->view_session(1, Ample), truth = plain->view_session(1, Ample);
        Random random(90);
        for (int step = 0; step < 3; ++step) {
            jitter(rows, random, 0.02);
            const auto ambiguous = test::ambiguous_pixels(rows.data, camera, {});
            Image d_colour = test::noise_image(camera.width, camera.height, 3, 20);
            test::blank(d_colour, ambiguous);
            Pictures found, expected;
            session->forward(0, spans(rows.data), rows.first, camera, {}, found.image);
            session->backward(d_colour, {}, found.gradients);
            truth->forward(0, spans(rows.data), rows.first, camera, {}, expected.image);
            truth->backward(d_colour, {}, expected.gradients);
            DOCTEST_CHECK(test::clear_error(found.image.colour.data, expected.image.colour.data, ambiguous) <
                          ImageTolerance);
            DOCTEST_CHECK(test::clear_error(found.image.alpha.data, expected.image.alpha.data, ambiguous) <
                          ImageTolerance);
            DOCTEST_CHECK(test::clear_error(found.image.blended, expected.image.blended, ambiguous) == 0);
            DOCTEST_CHECK(test::relative_l2(found.gradients.position, expected.gradients.position) <
                          GradientTolerance);
            DOCTEST_CHECK(test::relative_l2(found.gradients.log_scale, expected.gradients.log_scale) <
                          GradientTolerance);
            DOCTEST_CHECK(test::relative_l2(found.gradients.rotation, expected.gradients.rotation) <
                          GradientTolerance);
            DOCTEST_CHECK(test::relative_l2(found.gradients.opacity_logit, expected.gradients.opacity_logit) <
                          GradientTolerance);
            DOCTEST_CHECK(test::relative_l2(found.gradients.sh, expected.gradients.sh) < GradientTolerance);
        }
        DOCTEST_CHECK(session->work().continued == 3);
        DOCTEST_CHECK(truth->work().full == 3);
    }
}

}  // namespace view_session_test
