// The CUDA rasterizer against the plain one: its kernels and launches, on the processor (tests/agree/cuda has
// a device).
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/raster/cuda/emulated_device.h"
#include "engine/raster/cuda/self_check.h"
#include "tests/agree/raster/cuda_cases.h"

namespace cuda_test {

using namespace gse;
using namespace gse::raster;

DOCTEST_TEST_CASE("the CUDA kernels agree with the plain version") {
    const auto emulated = cuda::make_emulated_cuda_rasterizer();
    for (const test::Case& c : test::device_cases()) {
        DOCTEST_CAPTURE(c.name);
        test::compare(c, *emulated);
    }
}

DOCTEST_TEST_CASE("contributions and composited values of the CUDA kernels agree with the plain version") {
    const auto emulated = cuda::make_emulated_cuda_rasterizer();
    const auto plain = make_plain_rasterizer();
    for (const test::Case& c : test::device_cases()) {
        DOCTEST_CAPTURE(c.name);
        const GaussianData data = test::random_scene(c.recipe);
        const Camera camera = test::test_camera(c.width, c.height, c.distance);
        const auto ambiguous = test::ambiguous_pixels(data, camera, c.settings);
        Image mask(c.width, c.height, 1);
        for (std::size_t i = 0; i < mask.data.size(); ++i)
            mask.data[i] = ambiguous[i] != 0 ? 0.0f : static_cast<float>(i % 7) / 7;
        std::vector<double> masked(data.size(), 1.5), total(data.size(), 2.5), true_masked = masked,
                                                                               true_total = total;
        plain->contributions(spans(data), camera, c.settings, mask, true_masked, true_total);
        emulated->contributions(spans(data), camera, c.settings, mask, masked, total);
        DOCTEST_CHECK(test::relative_l2(masked, true_masked) < test::ContributionTolerance);
        // The total is also of the pixels that are left out of the mask.
        constexpr double ambiguity_tolerance = 1e-3;
        DOCTEST_CHECK(test::relative_l2(total, true_total) < ambiguity_tolerance);
        Random random(5);
        std::vector<float> values(data.size());
        for (float& value : values) value = static_cast<float>(random.uniform());
        Image found, expected;
        plain->forward_values(spans(data), camera, c.settings, values, expected);
        emulated->forward_values(spans(data), camera, c.settings, values, found);
        DOCTEST_CHECK(test::clear_error(found.data, expected.data, ambiguous) < test::ImageTolerance);
    }
}

DOCTEST_TEST_CASE("the order in which blocks and threads run does not tell, nor what was drawn before") {
    using cuda::EmulationOrder;
    const auto forward = cuda::make_emulated_cuda_rasterizer(EmulationOrder::Forward);
    const auto reversed = cuda::make_emulated_cuda_rasterizer(EmulationOrder::Reversed);
    for (const test::Case& c : test::device_cases()) {
        DOCTEST_CAPTURE(c.name);
        const GaussianData data = test::random_scene(c.recipe);
        const Camera camera = test::test_camera(c.width, c.height, c.distance);
        const test::Everything expected = test::run(*forward, data, camera, c.settings);
        DOCTEST_CHECK(test::identical(test::run(*reversed, data, camera, c.settings), expected));
        DOCTEST_CHECK(test::identical(test::run(*forward, data, camera, c.settings), expected));
        DOCTEST_CHECK(test::identical(
            test::run(*cuda::make_emulated_cuda_rasterizer(), data, camera, c.settings), expected));
    }
}

DOCTEST_TEST_CASE("the CUDA kernels draw splats at one depth in the order of their rows") {
    // Opaque copies at one place: whoever is first hides the others.
    GaussianData data = test::random_scene({.count = 700, .seed = 23, .log_scale = -0.5, .opacity = 3});
    for (std::size_t row = 1; row < data.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis) data.position[row * 3 + axis] = data.position[axis];
    const Camera camera = test::test_camera(50, 40);
    const auto ambiguous = test::ambiguous_pixels(data, camera, {});
    ForwardOutput image, truth;
    make_plain_rasterizer()->forward(spans(data), camera, {}, truth);
    cuda::make_emulated_cuda_rasterizer()->forward(spans(data), camera, {}, image);
    DOCTEST_CHECK(test::clear_error(image.colour.data, truth.colour.data, ambiguous) < test::ImageTolerance);
    DOCTEST_CHECK(test::clear_error(image.blended, truth.blended, ambiguous) == 0);
}

DOCTEST_TEST_CASE("the CUDA kernels count every row that means nothing, and give it no gradient") {
    GaussianData data = test::random_scene({.count = 300, .seed = 24});
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    inf = std::numeric_limits<float>::infinity();
    data.position[3 * 3] = nan;
    data.log_scale[7 * 3 + 1] = inf;
    data.rotation[11 * 4 + 2] = -inf;
    data.opacity_logit[13] = nan;
    data.position[17 * 3 + 1] = 1e30f;
    data.opacity_logit[19] = inf;   // an opaque one
    data.log_scale[23 * 3] = -inf;  // a flat one
    const Camera camera = test::test_camera(70, 50);
    const test::Everything found = test::run(*cuda::make_emulated_cuda_rasterizer(), data, camera, {});
    const test::Everything expected = test::run(*make_plain_rasterizer(), data, camera, {});
    DOCTEST_CHECK(found.image.dropped_rows == 5);
    DOCTEST_CHECK(expected.image.dropped_rows == 5);
    DOCTEST_CHECK(test::all_finite(found.image));
    DOCTEST_CHECK(test::all_finite(found.gradients));
    for (const std::size_t row : {3u, 7u, 11u, 13u, 17u}) DOCTEST_CHECK(found.gradients.visible[row] == 0);
    DOCTEST_CHECK(found.gradients.visible == expected.gradients.visible);
}

DOCTEST_TEST_CASE("the self-check passes on the processor's stand-in") {
    for (const auto order : {cuda::EmulationOrder::Forward, cuda::EmulationOrder::Reversed}) {
        const SelfCheck check = check_against_plain(*cuda::make_emulated_cuda_rasterizer(order));
        DOCTEST_INFO(check.figures());
        DOCTEST_CHECK(check.passed());
    }
}

}  // namespace cuda_test
