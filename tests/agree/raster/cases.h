// The scenes on which every version of the rasterizer has to agree with the plain one, and the comparison.
#pragma once

#include <doctest/doctest.h>

#include "tests/agree/raster/scenes.h"

namespace gse::test {

// Float sums of up to a few hundred terms below 1; the goldens' gates are 2e-5 and 1e-4.
inline constexpr double ImageTolerance = 1e-5;
inline constexpr double GradientTolerance = 1e-4;
inline constexpr double ContributionTolerance = 1e-5;

struct Case {
    std::string name;
    SceneRecipe recipe;
    int width = 96, height = 64;
    raster::Settings settings;
    double distance = 4.0;
};

inline std::vector<Case> cases() {
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
    raster::Settings odd;
    odd.antialiased = true;
    odd.background = {0.3f, 0.6f, 0.9f};
    odd.sh_degree = 1;
    odd.negative_colour_slope = 0.25f;
    odd.blur_px2 = 0.1f;
    all.push_back({"odd settings", {.count = 600, .seed = 12, .log_scale = -3.5}, 96, 64, odd});
    return all;
}

/// `slack` times the tolerances.
inline void compare(const Case& c, raster::Rasterizer& fast, double slack = 1) {
    const GaussianData data = random_scene(c.recipe);
    const Camera camera = test_camera(c.width, c.height, c.distance);
    const auto plain = raster::make_plain_rasterizer();
    const auto ambiguous = ambiguous_pixels(data, camera, c.settings);
    raster::ForwardOutput image, truth;
    plain->forward(spans(data), camera, c.settings, truth);
    fast.forward(spans(data), camera, c.settings, image);
    DOCTEST_CHECK(clear_error(image.colour.data, truth.colour.data, ambiguous) < slack * ImageTolerance);
    DOCTEST_CHECK(clear_error(image.alpha.data, truth.alpha.data, ambiguous) < slack * ImageTolerance);
    DOCTEST_CHECK(clear_error(image.depth.data, truth.depth.data, ambiguous) < 10 * slack * ImageTolerance);
    DOCTEST_CHECK(clear_error(image.blended, truth.blended, ambiguous) == 0);

    Image d_colour = noise_image(c.width, c.height, 3, 20), d_alpha = noise_image(c.width, c.height, 1, 21);
    blank(d_colour, ambiguous);
    blank(d_alpha, ambiguous);
    raster::Gradients found, expected;
    plain->backward(d_colour, d_alpha, 0, expected);
    fast.backward(d_colour, d_alpha, 0, found);
    DOCTEST_CHECK(relative_l2(found.position, expected.position) < slack * GradientTolerance);
    DOCTEST_CHECK(relative_l2(found.log_scale, expected.log_scale) < slack * GradientTolerance);
    DOCTEST_CHECK(relative_l2(found.rotation, expected.rotation) < slack * GradientTolerance);
    DOCTEST_CHECK(relative_l2(found.opacity_logit, expected.opacity_logit) < slack * GradientTolerance);
    DOCTEST_CHECK(relative_l2(found.sh, expected.sh) < slack * GradientTolerance);
    DOCTEST_CHECK(relative_l2(found.mean2d_norm, expected.mean2d_norm) < slack * GradientTolerance);
}

}  // namespace gse::test
