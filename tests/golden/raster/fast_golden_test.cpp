// The fast rasterizer against gsplat's double-precision reference, at the gates of goldens_raster/README.md.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/thread_pool.h"
#include "engine/raster/cuda/emulated_device.h"
#include "tests/golden/raster/golden_case.h"

namespace fast_golden_test {

using namespace gse;
using namespace gse::raster;

namespace {

// A correct float32 build shows 3e-6 (image), 4e-6 (alpha) and 1e-6..3e-5 (gradients); the README's gates:
constexpr double ImageTolerance = 2e-5;
constexpr double AlphaTolerance = 2e-5;
constexpr double GradientTolerance = 1e-4;

Image image_from(const std::vector<double>& values, const Camera& camera, int channels) {
    Image image(camera.width, camera.height, channels);
    image.data.assign(values.begin(), values.end());
    return image;
}

void equal_goldens(Rasterizer& rasterizer) {
    for (const std::string& name : test::golden_names()) {
        DOCTEST_CAPTURE(name);
        const test::GoldenCase golden(name);
        const test::Tensors& t = golden.tensors;
        ForwardOutput image;
        rasterizer.forward(spans(golden.data), golden.camera, golden.settings, image);
        DOCTEST_CHECK(test::clear_pixel_error(image.colour.data, t["render"], t["ambiguous"]) <
                      ImageTolerance);
        DOCTEST_CHECK(test::clear_pixel_error(image.alpha.data, t["alpha"], t["ambiguous"]) < AlphaTolerance);
        DOCTEST_CHECK(test::relative_l2(image.depth.data, t["depth_acc"]) < AlphaTolerance);
        DOCTEST_CHECK(test::clear_pixel_error(image.blended, t["n_contrib"], t["ambiguous"]) == 0);
        Gradients g;
        rasterizer.backward(image_from(t["v_render"], golden.camera, 3),
                            image_from(t["v_alpha"], golden.camera, 1), 0, g);
        DOCTEST_CHECK(test::relative_l2(g.position, t["g_means"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(g.log_scale, t["g_log_scales"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(g.rotation, t["g_quats"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(g.opacity_logit, t["g_logit_opacities"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(g.sh, t["g_sh"]) < GradientTolerance);
    }
}

}  // namespace

DOCTEST_TEST_CASE("fast rasterizer equals the goldens") {
    ThreadPool pool(2);
    equal_goldens(*make_fast_rasterizer(pool));
}

DOCTEST_TEST_CASE("the CUDA kernels equal the goldens") {
    equal_goldens(*cuda::make_emulated_cuda_rasterizer());
}

}  // namespace fast_golden_test
