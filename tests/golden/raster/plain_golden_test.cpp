// The plain rasterizer against gsplat's double-precision reference: images, 2D-stage and raw-parameter
// gradients.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "tests/golden/raster/golden_case.h"

namespace plain_golden_test {

using namespace gse;
using namespace gse::raster;

namespace {

// Both sides are double precision; what remains is the order of sums.
constexpr double ImageTolerance = 1e-10;
constexpr double GradientTolerance = 1e-9;

plain::PictureGradient picture_gradient(const test::GoldenCase& golden) {
    return {golden.tensors["v_render"], golden.tensors["v_alpha"]};
}

struct Stage {
    std::vector<double> means2d, conics, colors, opacities;
};

Stage stage_gradients(const test::GoldenCase& golden, const plain::SplatList& list,
                      const std::vector<plain::SplatGradient>& gradients) {
    const std::size_t n = golden.data.size();
    Stage stage{std::vector<double>(n * 2), std::vector<double>(n * 3), std::vector<double>(n * 3),
                std::vector<double>(n)};
    for (std::size_t i = 0; i < list.splats.size(); ++i) {
        const std::size_t row = list.splats[i].row;
        const plain::SplatGradient& d = gradients[i];
        stage.means2d[row * 2] = d.x;
        stage.means2d[row * 2 + 1] = d.y;
        stage.conics[row * 3] = d.a;
        stage.conics[row * 3 + 1] = d.b;
        stage.conics[row * 3 + 2] = d.c;
        for (std::size_t c = 0; c < 3; ++c) stage.colors[row * 3 + c] = d.colour[c];
        stage.opacities[row] = d.log_opacity / list.splats[i].opacity;
    }
    return stage;
}

struct Raw {
    std::vector<double> means, scales, quats, logits, sh;
};

Raw raw_gradients(const test::GoldenCase& golden, const plain::SplatList& list,
                  const std::vector<plain::SplatGradient>& gradients) {
    const std::size_t n = golden.data.size(), stride = golden.data.sh_stride();
    Raw raw{std::vector<double>(n * 3), std::vector<double>(n * 3), std::vector<double>(n * 4),
            std::vector<double>(n), std::vector<double>(n * stride)};
    for (std::size_t i = 0; i < list.splats.size(); ++i) {
        plain::RowGradient d;
        const std::size_t row = list.splats[i].row;
        plain::project_backward(golden.wide, golden.view(), row, gradients[i], d);
        std::copy(d.position.begin(), d.position.end(), &raw.means[row * 3]);
        std::copy(d.log_scale.begin(), d.log_scale.end(), &raw.scales[row * 3]);
        std::copy(d.rotation.begin(), d.rotation.end(), &raw.quats[row * 4]);
        raw.logits[row] = d.opacity_logit;
        std::copy_n(d.sh.begin(), stride, &raw.sh[row * stride]);
    }
    return raw;
}

}  // namespace

DOCTEST_TEST_CASE("plain rasterizer equals the goldens") {
    for (const std::string& name : test::golden_names()) {
        DOCTEST_CAPTURE(name);
        const test::GoldenCase golden(name);
        const test::Tensors& t = golden.tensors;
        const plain::View view = golden.view();
        plain::SplatList list;
        plain::project_all(golden.wide, view, list);
        DOCTEST_CHECK(list.unusable_rows == 0);
        plain::Picture picture;
        plain::composite(list, view, picture);
        DOCTEST_CHECK(test::clear_pixel_error(picture.colour, t["render"], t["ambiguous"]) < ImageTolerance);
        DOCTEST_CHECK(test::clear_pixel_error(picture.alpha, t["alpha"], t["ambiguous"]) < ImageTolerance);
        DOCTEST_CHECK(test::relative_l2(picture.depth, t["depth_acc"]) < ImageTolerance);
        DOCTEST_CHECK(test::clear_pixel_error(picture.blended, t["n_contrib"], t["ambiguous"]) == 0);

        std::vector<plain::SplatGradient> gradients;
        plain::composite_backward(list, view, picture_gradient(golden), gradients);
        const Stage stage = stage_gradients(golden, list, gradients);
        DOCTEST_CHECK(test::relative_l2(stage.means2d, t["g_means2d"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(stage.conics, t["g_conics"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(stage.colors, t["g_colors"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(stage.opacities, t["g_opacities"]) < GradientTolerance);
        const Raw raw = raw_gradients(golden, list, gradients);
        DOCTEST_CHECK(test::relative_l2(raw.means, t["g_means"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(raw.scales, t["g_log_scales"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(raw.quats, t["g_quats"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(raw.logits, t["g_logit_opacities"]) < GradientTolerance);
        DOCTEST_CHECK(test::relative_l2(raw.sh, t["g_sh"]) < GradientTolerance);
    }
}

}  // namespace plain_golden_test
