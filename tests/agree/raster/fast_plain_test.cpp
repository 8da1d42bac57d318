// Every fast version against the plain double one: images, gradients, contributions, composited values.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/agree/raster/scenes.h"

using namespace gse;
using namespace gse::raster;

namespace {

// Float sums of up to a few hundred terms below 1; the goldens' gates are 2e-5 and 1e-4.
constexpr double ImageTolerance = 1e-5;
constexpr double GradientTolerance = 1e-4;
constexpr double ContributionTolerance = 1e-5;

struct Case {
    std::string name;
    test::SceneRecipe recipe;
    int width = 96, height = 64;
    Settings settings;
    double distance = 4.0;
};

std::vector<Case> cases() {
    std::vector<Case> all;
    all.push_back({"random", {}, 96, 64, {}});
    all.push_back({"dense", {.count = 1500, .seed = 2, .log_scale = -1.8, .opacity = 2.5}, 80, 80, {}});
    all.push_back({"ragged", {.count = 400, .seed = 3}, 101, 67, {}});
    all.push_back({"small splats", {.count = 4000, .seed = 4, .log_scale = -4.5}, 120, 90, {}});
    all.push_back({"needles", {.count = 300, .seed = 5, .log_scale = -2.5, .stretch = 2.5}, 96, 96, {}});
    all.push_back({"opaque", {.count = 300, .seed = 6, .opacity = 8, .opacity_spread = 4}, 64, 48, {}});
    all.push_back({"degree 0", {.count = 200, .seed = 7, .sh_degree = 0}, 50, 50, {}});
    all.push_back({"degree 1", {.count = 200, .seed = 8, .sh_degree = 1}, 50, 50, {}});
    all.push_back({"degree 2", {.count = 200, .seed = 9, .sh_degree = 2}, 50, 50, {}});
    all.push_back({"camera inside", {.count = 500, .seed = 10}, 64, 64, {}, 0.8});
    all.push_back({"wider than a window of bins", {.count = 60, .seed = 11, .log_scale = -0.5}, 700, 20, {}});
    Settings odd;
    odd.antialiased = true;
    odd.background = {0.3f, 0.6f, 0.9f};
    odd.sh_degree = 1;
    odd.negative_colour_slope = 0.25f;
    odd.blur_px2 = 0.1f;
    all.push_back({"odd settings", {.count = 600, .seed = 12, .log_scale = -3.5}, 96, 64, odd});
    return all;
}

void compare(const Case& c, Rasterizer& fast) {
    const GaussianData data = test::random_scene(c.recipe);
    const Camera camera = test::test_camera(c.width, c.height, c.distance);
    const auto plain = make_plain_rasterizer();
    const auto ambiguous = test::ambiguous_pixels(data, camera, c.settings);
    ForwardOutput image, truth;
    plain->forward(spans(data), camera, c.settings, truth);
    fast.forward(spans(data), camera, c.settings, image);
    DOCTEST_CHECK(test::clear_error(image.colour.data, truth.colour.data, ambiguous) < ImageTolerance);
    DOCTEST_CHECK(test::clear_error(image.alpha.data, truth.alpha.data, ambiguous) < ImageTolerance);
    DOCTEST_CHECK(test::clear_error(image.depth.data, truth.depth.data, ambiguous) < 10 * ImageTolerance);
    DOCTEST_CHECK(test::clear_error(image.blended, truth.blended, ambiguous) == 0);

    Image d_colour = test::noise_image(c.width, c.height, 3, 20),
          d_alpha = test::noise_image(c.width, c.height, 1, 21);
    test::blank(d_colour, ambiguous);
    test::blank(d_alpha, ambiguous);
    Gradients found, expected;
    plain->backward(d_colour, d_alpha, 0, expected);
    fast.backward(d_colour, d_alpha, 0, found);
    DOCTEST_CHECK(test::relative_l2(found.position, expected.position) < GradientTolerance);
    DOCTEST_CHECK(test::relative_l2(found.log_scale, expected.log_scale) < GradientTolerance);
    DOCTEST_CHECK(test::relative_l2(found.rotation, expected.rotation) < GradientTolerance);
    DOCTEST_CHECK(test::relative_l2(found.opacity_logit, expected.opacity_logit) < GradientTolerance);
    DOCTEST_CHECK(test::relative_l2(found.sh, expected.sh) < GradientTolerance);
    DOCTEST_CHECK(test::relative_l2(found.mean2d_norm, expected.mean2d_norm) < GradientTolerance);
}

}  // namespace

DOCTEST_TEST_CASE("every fast version agrees with the plain one") {
    ThreadPool pool(2);
    for (const std::string& kernels : raster::usable_kernels()) {
        const auto fast = raster::make_fast_rasterizer(pool, kernels);
        DOCTEST_CHECK(fast->name() == kernels);
        for (const Case& c : cases()) {
            DOCTEST_CAPTURE(kernels);
            DOCTEST_CAPTURE(c.name);
            compare(c, *fast);
        }
    }
}

DOCTEST_TEST_CASE("contributions and composited values agree with the plain version") {
    ThreadPool pool(2);
    const GaussianData data = test::random_scene({.count = 800, .seed = 31});
    const Camera camera = test::test_camera(83, 61);
    const auto plain = make_plain_rasterizer();
    Image mask(camera.width, camera.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = i % 7 < 3 ? 1.0f : 0.0f;
    std::vector<double> masked(data.size()), total(data.size());
    plain->contributions(spans(data), camera, {}, mask, masked, total);
    Random random(5);
    std::vector<float> values(data.size());
    for (float& value : values) value = static_cast<float>(random.uniform());
    Image expected;
    plain->forward_values(spans(data), camera, {}, values, expected);
    const auto ambiguous = test::ambiguous_pixels(data, camera, {});
    for (const std::string& kernels : raster::usable_kernels()) {
        DOCTEST_CAPTURE(kernels);
        const auto fast = raster::make_fast_rasterizer(pool, kernels);
        std::vector<double> fast_masked(data.size()), fast_total(data.size());
        fast->contributions(spans(data), camera, {}, mask, fast_masked, fast_total);
        // Ambiguous pixels are a few per thousand here; each may move one weight of 1/255.
        constexpr double ambiguity_tolerance = 3e-4;
        DOCTEST_CHECK(test::relative_l2(fast_masked, masked) < ambiguity_tolerance);
        DOCTEST_CHECK(test::relative_l2(fast_total, total) < ambiguity_tolerance);
        Image found;
        fast->forward_values(spans(data), camera, {}, values, found);
        DOCTEST_CHECK(test::clear_error(found.data, expected.data, ambiguous) < ImageTolerance);
    }
}

DOCTEST_TEST_CASE("contributions equal the gradient of a constant colour, and add up to the alpha image") {
    // With degree 0 the colour is 0.5 + C0 f_dc, so dL/df_dc = C0 sum of alpha T dL/dcolour.
    ThreadPool pool(2);
    GaussianData data = test::random_scene({.count = 500, .seed = 41, .sh_degree = 0});
    for (float& value : data.sh) value = std::abs(value);  // above the clamp
    const Camera camera = test::test_camera(77, 58);
    Image mask = test::noise_image(camera.width, camera.height, 1, 42);
    Image d_colour(camera.width, camera.height, 3);
    for (std::size_t i = 0; i < mask.data.size(); ++i) d_colour.data[i * 3] = mask.data[i];
    std::vector<std::unique_ptr<Rasterizer>> all;
    all.push_back(make_plain_rasterizer());
    for (const std::string& kernels : raster::usable_kernels())
        all.push_back(raster::make_fast_rasterizer(pool, kernels));
    for (const auto& rasterizer : all) {
        DOCTEST_CAPTURE(rasterizer->name());
        std::vector<double> masked(data.size()), total(data.size());
        ForwardOutput image;
        Gradients g;
        rasterizer->forward(spans(data), camera, {}, image);
        rasterizer->contributions(spans(data), camera, {}, mask, masked,
                                  total);  // must not disturb the next line
        rasterizer->backward(d_colour, {}, 0, g);
        std::vector<double> from_gradient(data.size());
        for (std::size_t row = 0; row < data.size(); ++row)
            from_gradient[row] = static_cast<double>(g.sh[row * 3]) / ShC0;
        DOCTEST_CHECK(test::relative_l2(masked, from_gradient) < ContributionTolerance);
        double weights = 0, alphas = 0;
        for (const double weight : total) weights += weight;
        for (const float alpha : image.alpha.data) alphas += static_cast<double>(alpha);
        DOCTEST_CHECK(std::abs(weights - alphas) < ContributionTolerance * alphas);
        Image ones;
        rasterizer->forward_values(spans(data), camera, {}, std::vector<float>(data.size(), 1.0f), ones);
        DOCTEST_CHECK(test::relative_l2(ones.data, image.alpha.data) < ContributionTolerance);
    }
}
