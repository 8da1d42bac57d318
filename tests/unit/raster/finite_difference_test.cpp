// The plain rasterizer's derivative against central differences of its own images, in double precision.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/raster/cuda/emulated_device.h"
#include "tests/agree/raster/scenes.h"

namespace finite_difference_test {

using namespace gse;
using namespace gse::raster;

namespace {

constexpr double Step = 1e-6;
// Truncation (h^2) and cancellation (1e-16 / h) both lie near 1e-9 of the largest derivative of the tensor.
constexpr double Tolerance = 2e-7;

/// Inputs in double precision that can be nudged.
struct Wide {
    std::vector<double> position, log_scale, rotation, opacity_logit, sh;
    int sh_degree = 0;

    explicit Wide(const GaussianData& data)
        : position(data.position.begin(), data.position.end()),
          log_scale(data.log_scale.begin(), data.log_scale.end()),
          rotation(data.rotation.begin(), data.rotation.end()),
          opacity_logit(data.opacity_logit.begin(), data.opacity_logit.end()),
          sh(data.sh.begin(), data.sh.end()), sh_degree(data.sh_degree) {}
    plain::Inputs inputs() const {
        return {opacity_logit.size(), sh_degree, position, log_scale, rotation, opacity_logit, sh};
    }
};

struct Problem {
    Camera camera;
    Settings settings;
    plain::PictureGradient gradient;

    Problem(int width, int height, const Settings& s)
        : camera(test::test_camera(width, height)), settings(s) {
        const Image d_colour = test::noise_image(width, height, 3, 1),
                    d_alpha = test::noise_image(width, height, 1, 2);
        gradient.colour.assign(d_colour.data.begin(), d_colour.data.end());
        gradient.alpha.assign(d_alpha.data.begin(), d_alpha.data.end());
    }
    plain::View view() const { return {camera, settings}; }

    double loss(const Wide& wide) const {
        plain::SplatList list;
        plain::Picture picture;
        plain::project_all(wide.inputs(), view(), list);
        plain::composite(list, view(), picture);
        double sum = 0;
        for (std::size_t i = 0; i < picture.colour.size(); ++i) sum += picture.colour[i] * gradient.colour[i];
        for (std::size_t i = 0; i < picture.alpha.size(); ++i) sum += picture.alpha[i] * gradient.alpha[i];
        return sum;
    }
};

/// Analytic gradients of all rows, flat, in the order of Wide's members.
Wide analytic(const Problem& problem, const Wide& wide) {
    Wide g = wide;
    for (auto* values : {&g.position, &g.log_scale, &g.rotation, &g.opacity_logit, &g.sh})
        std::fill(values->begin(), values->end(), 0.0);
    plain::SplatList list;
    std::vector<plain::SplatGradient> splat_gradients;
    plain::project_all(wide.inputs(), problem.view(), list);
    plain::composite_backward(list, problem.view(), problem.gradient, splat_gradients);
    const std::size_t stride = wide.sh.size() / wide.opacity_logit.size();
    plain::RowGradient d;
    for (std::size_t i = 0; i < list.splats.size(); ++i) {
        const std::size_t row = list.splats[i].row;
        plain::project_backward(wide.inputs(), problem.view(), row, splat_gradients[i], d);
        std::copy(d.position.begin(), d.position.end(), &g.position[row * 3]);
        std::copy(d.log_scale.begin(), d.log_scale.end(), &g.log_scale[row * 3]);
        std::copy(d.rotation.begin(), d.rotation.end(), &g.rotation[row * 4]);
        g.opacity_logit[row] = d.opacity_logit;
        std::copy_n(d.sh.begin(), stride, &g.sh[row * stride]);
    }
    return g;
}

/// Largest error of a tensor's derivatives over the largest derivative. `stride` thins out long tensors.
double difference_error(const Problem& problem, Wide wide, std::vector<double> Wide::*member,
                        const std::vector<double>& expected, std::size_t stride) {
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < expected.size(); i += stride) {
        double& value = (wide.*member)[i];
        const double old = value;
        value = old + Step;
        const double above = problem.loss(wide);
        value = old - Step;
        const double below = problem.loss(wide);
        value = old;
        worst = std::max(worst, std::abs((above - below) / (2 * Step) - expected[i]));
        largest = std::max(largest, std::abs(expected[i]));
    }
    return largest > 0 ? worst / largest : INFINITY;
}

void check_all(const Problem& problem, const Wide& wide) {
    const Wide g = analytic(problem, wide);
    DOCTEST_CHECK(difference_error(problem, wide, &Wide::position, g.position, 1) < Tolerance);
    DOCTEST_CHECK(difference_error(problem, wide, &Wide::log_scale, g.log_scale, 1) < Tolerance);
    DOCTEST_CHECK(difference_error(problem, wide, &Wide::rotation, g.rotation, 1) < Tolerance);
    DOCTEST_CHECK(difference_error(problem, wide, &Wide::opacity_logit, g.opacity_logit, 1) < Tolerance);
    DOCTEST_CHECK(difference_error(problem, wide, &Wide::sh, g.sh, 7) < Tolerance);
}

}  // namespace

DOCTEST_TEST_CASE("plain gradients equal central differences") {
    Settings settings;
    settings.background = {0.2f, 0.5f, 0.7f};
    DOCTEST_SUBCASE("as the program renders") {}
    DOCTEST_SUBCASE("with opacity compensation") { settings.antialiased = true; }
    DOCTEST_SUBCASE("with less blur and fewer bands") {
        settings.blur_px2 = 0.05f;
        settings.sh_degree = 1;
    }
    const Problem problem(33, 26, settings);
    check_all(problem,
              Wide(test::random_scene({.count = 14, .seed = 81, .log_scale = -1.3, .opacity = 1.0})));
}

DOCTEST_TEST_CASE("plain gradients equal central differences where the frustum clamps the Jacobian") {
    GaussianData data =
        test::random_scene({.count = 6, .seed = 82, .log_scale = -0.2, .stretch = 0.2, .opacity = 3.0});
    const Problem problem(24, 20, {});
    const Camera& camera = problem.camera;
    for (std::size_t row = 0; row < data.size(); ++row) {
        // Well outside the picture on each side, large enough to reach into it.
        const double angle = 1.1 * static_cast<double>(row);
        // Different depths: the order must not change under a nudge.
        const Vec3 point{2.6 * std::cos(angle), 2.6 * std::sin(angle), 3.0 + 0.1 * static_cast<double>(row)};
        const Vec3 world = camera.rotation.transposed() * (point - camera.translation);
        for (int axis = 0; axis < 3; ++axis)
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(world[axis]);
    }
    check_all(problem, Wide(data));
}

DOCTEST_TEST_CASE("the clamp of dark colours lets through the slope that was asked for") {
    GaussianData data =
        test::random_scene({.count = 1, .seed = 83, .sh_degree = 0, .log_scale = -1.0, .opacity = 2.0});
    data.position.assign(3, 0.0f);
    data.sh = {-3.0f, 1.0f, -3.0f};  // red and blue are clamped at 0
    Settings exact, leaky;
    leaky.negative_colour_slope = 0.01f;
    const Camera camera = test::test_camera(32, 32);
    const Image d_colour(32, 32, 3, 1.0f);
    ThreadPool pool(1);
    std::vector<std::unique_ptr<Rasterizer>> all;
    all.push_back(make_plain_rasterizer());
    for (const std::string& kernels : raster::usable_kernels())
        all.push_back(raster::make_fast_rasterizer(pool, kernels));
    all.push_back(raster::cuda::make_emulated_cuda_rasterizer());
    for (const auto& rasterizer : all) {
        ForwardOutput image;
        Gradients strict, soft;
        rasterizer->forward(spans(data), camera, exact, image);
        rasterizer->backward(d_colour, {}, 0, strict);
        rasterizer->forward(spans(data), camera, leaky, image);
        rasterizer->backward(d_colour, {}, 0, soft);
        DOCTEST_CHECK(strict.sh[0] == 0.0f);
        DOCTEST_CHECK(strict.sh[2] == 0.0f);
        DOCTEST_CHECK(strict.sh[1] > 0.0f);
        DOCTEST_CHECK(soft.sh[0] == doctest::Approx(0.01 * static_cast<double>(strict.sh[1])).epsilon(1e-4));
        DOCTEST_CHECK(soft.sh[1] == strict.sh[1]);
    }
}

}  // namespace finite_difference_test
