// Every fast version against the plain double one: images, gradients, contributions, composited values.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/raster/cuda/emulated_device.h"
#include "tests/agree/raster/cases.h"

namespace fast_plain_test {

using namespace gse;
using namespace gse::raster;

DOCTEST_TEST_CASE("every fast version agrees with the plain one") {
    ThreadPool pool(2);
    for (const std::string& kernels : raster::usable_kernels()) {
        const auto fast = raster::make_fast_rasterizer(pool, kernels);
        DOCTEST_CHECK(fast->name() == kernels);
        for (const test::Case& c : test::cases()) {
            DOCTEST_CAPTURE(kernels);
            DOCTEST_CAPTURE(c.name);
            test::compare(c, *fast);
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
        DOCTEST_CHECK(test::clear_error(found.data, expected.data, ambiguous) < test::ImageTolerance);
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
    all.push_back(raster::cuda::make_emulated_cuda_rasterizer());
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
        DOCTEST_CHECK(test::relative_l2(masked, from_gradient) < test::ContributionTolerance);
        double weights = 0, alphas = 0;
        for (const double weight : total) weights += weight;
        for (const float alpha : image.alpha.data) alphas += static_cast<double>(alpha);
        DOCTEST_CHECK(std::abs(weights - alphas) < test::ContributionTolerance * alphas);
        Image ones;
        rasterizer->forward_values(spans(data), camera, {}, std::vector<float>(data.size(), 1.0f), ones);
        DOCTEST_CHECK(test::relative_l2(ones.data, image.alpha.data) < test::ContributionTolerance);
    }
}

DOCTEST_TEST_CASE("colours that nobody wants are left out only where all are finite, which changes no bit") {
    ThreadPool pool(2);
    const Camera camera = test::test_camera(83, 61);
    const Image mask = test::noise_image(camera.width, camera.height, 1, 3);
    const float infinite = std::numeric_limits<float>::infinity();
    for (const float odd :
         {0.5f, std::numeric_limits<float>::quiet_NaN(), infinite, -infinite, 2e30f, 3e38f}) {
        DOCTEST_CAPTURE(odd);
        GaussianData data = test::random_scene({.count = 900, .seed = 33});
        for (std::size_t row = 3; row < data.size(); row += 7)
            data.sh[row * data.sh_stride() + row % data.sh_stride()] = odd;
        const std::vector<float>& values = data.opacity_logit;
        for (const std::string& kernels : raster::usable_kernels()) {
            DOCTEST_CAPTURE(kernels);
            const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
            const GaussianSet set(data);  // remembers what its colours are; the arrays alone do not
            std::vector<double> masked(data.size()), total(data.size()), set_masked(data.size()),
                set_total(data.size());
            rasterizer->contributions(spans(data), camera, {}, mask, masked, total);
            rasterizer->contributions(set.spans(), camera, {}, mask, set_masked, set_total);
            DOCTEST_CHECK(set_masked == masked);
            DOCTEST_CHECK(set_total == total);
            Image expected, found;
            rasterizer->forward_values(spans(data), camera, {}, values, expected);
            rasterizer->forward_values(set.spans(), camera, {}, values, found);
            DOCTEST_CHECK(found.data == expected.data);
            DOCTEST_CHECK(*set.spans().colours_known ==
                          (odd == 0.5f ? ColoursKnown::Finite : ColoursKnown::NotAll));
            ForwardOutput picture, set_picture;  // a picture wants them
            rasterizer->forward(spans(data), camera, {}, picture);
            rasterizer->forward(set.spans(), camera, {}, set_picture);
            DOCTEST_CHECK(set_picture.colour.data == picture.colour.data);
            DOCTEST_CHECK(
                test::relative_l2(picture.alpha.data, std::vector<float>(picture.alpha.data.size())) > 0);
        }
    }
}

}  // namespace fast_plain_test
