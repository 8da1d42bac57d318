// Hostile scenes through every version: never a non-finite pixel or gradient, and what is dropped is counted.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/raster/cuda/emulated_device.h"
#include "tests/agree/raster/scenes.h"

namespace hostile_scenes_test {

using namespace gse;
using namespace gse::raster;

namespace {

constexpr float Inf = std::numeric_limits<float>::infinity();
constexpr float NaN = std::numeric_limits<float>::quiet_NaN();
// Looser than between tame scenes: needles and far worlds cost a digit or two.
constexpr double ImageTolerance = 5e-5;
// Ambiguous pixels are part of these sums.
constexpr double ContributionTolerance = 2e-3;

struct Hostile {
    GaussianData data = test::random_scene({.count = 200, .seed = 101});
    Camera camera = test::test_camera(70, 53);
    Settings settings;
    std::size_t dropped = 0;
    bool compare = true;  // with the plain version
};

struct Everyone {
    Everyone() {
        versions.push_back(make_plain_rasterizer());
        for (const std::string& kernels : raster::usable_kernels())
            versions.push_back(raster::make_fast_rasterizer(pool, kernels));
        versions.push_back(cuda::make_emulated_cuda_rasterizer());
    }
    ThreadPool pool{2};
    std::vector<std::unique_ptr<Rasterizer>> versions;
};

void survive(const Hostile& h) {
    Everyone everyone;
    const auto ambiguous = test::ambiguous_pixels(h.data, h.camera, h.settings);
    const Image d_colour = test::noise_image(h.camera.width, h.camera.height, 3, 5);
    const Image d_alpha = test::noise_image(h.camera.width, h.camera.height, 1, 6);
    ForwardOutput truth;
    std::vector<double> true_total;
    for (const auto& version : everyone.versions) {
        DOCTEST_CAPTURE(version->name());
        ForwardOutput image;
        Gradients gradients;
        version->forward(spans(h.data), h.camera, h.settings, image);
        version->backward(d_colour, d_alpha, 0, gradients);
        DOCTEST_CHECK(test::all_finite(image));
        DOCTEST_CHECK(test::all_finite(gradients));
        DOCTEST_CHECK(image.dropped_rows == h.dropped);
        DOCTEST_CHECK(gradients.opacity_logit.size() == h.data.size());
        std::vector<double> masked(h.data.size()), total(h.data.size());
        version->contributions(spans(h.data), h.camera, h.settings, d_alpha, masked, total);
        for (const double value : total) DOCTEST_REQUIRE(std::isfinite(value));
        if (version->name() == "plain") {
            truth = image;
            true_total = total;
            continue;
        }
        DOCTEST_CHECK(test::relative_l2(total, true_total) < ContributionTolerance);
        if (h.compare)
            DOCTEST_CHECK(test::clear_error(image.colour.data, truth.colour.data, ambiguous) <
                          ImageTolerance);
    }
}

/// Puts the world's origin far away; the scene and the camera move together.
void move_world(Hostile& h, const Vec3& by) {
    for (std::size_t row = 0; row < h.data.size(); ++row)
        for (int axis = 0; axis < 3; ++axis)
            h.data.position[row * 3 + static_cast<std::size_t>(axis)] += static_cast<float>(by[axis]);
    h.camera.translation = h.camera.translation - h.camera.rotation * by;
}

}  // namespace

DOCTEST_TEST_CASE("nothing, one, and nothing in view") {
    Hostile h;
    DOCTEST_SUBCASE("empty") { h.data = test::random_scene({.count = 0}); }
    DOCTEST_SUBCASE("one") { h.data = test::random_scene({.count = 1, .log_scale = -1}); }
    DOCTEST_SUBCASE("all behind") {
        for (std::size_t row = 0; row < h.data.size(); ++row) {
            const Vec3 behind =
                h.camera.centre() - h.camera.forward() * (1.0 + 0.01 * static_cast<double>(row));
            for (int axis = 0; axis < 3; ++axis)
                h.data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(behind[axis]);
        }
    }
    DOCTEST_SUBCASE("all transparent") { h.data.opacity_logit.assign(h.data.size(), -9.0f); }
    survive(h);
}

DOCTEST_TEST_CASE("any image size") {
    for (const auto& size : {std::pair{1, 1}, {5, 3}, {17, 1}, {1, 33}, {16, 16}, {31, 47}, {64, 4}}) {
        const int width = size.first, height = size.second;  // clang 14 captures no structured binding
        Hostile h;
        h.camera = test::test_camera(width, height);
        DOCTEST_CAPTURE(width);
        survive(h);
    }
}

DOCTEST_TEST_CASE("values that mean nothing are dropped and counted") {
    Hostile h;
    h.data.position[0 * 3 + 1] = NaN;
    h.data.position[1 * 3] = Inf;
    h.data.position[2 * 3 + 2] = -Inf;
    h.data.log_scale[3 * 3] = NaN;
    h.data.log_scale[4 * 3 + 1] = Inf;
    h.data.rotation[5 * 4 + 3] = NaN;
    h.data.rotation[6 * 4] = Inf;
    h.data.opacity_logit[7] = NaN;
    h.data.position[8 * 3] = 3e38f;
    h.dropped = 9;
    survive(h);
    // Spherical harmonics are read for what is drawn only.
    h.data.opacity_logit[10] = 3.0f;
    for (std::size_t axis = 0; axis < 3; ++axis) h.data.position[10 * 3 + axis] = 0.0f;
    h.data.sh[10 * h.data.sh_stride() + 5] = NaN;
    h.dropped = 10;
    survive(h);
    GaussianData all_bad = h.data;
    std::fill(all_bad.position.begin(), all_bad.position.end(), NaN);
    h.data = all_bad;
    h.dropped = h.data.size();
    survive(h);
}

DOCTEST_TEST_CASE("legal infinities and degenerate shapes") {
    Hostile h;
    DOCTEST_SUBCASE("logits at infinity") {
        for (std::size_t row = 0; row < h.data.size(); ++row)
            h.data.opacity_logit[row] = row % 2 == 0 ? Inf : -Inf;
    }
    DOCTEST_SUBCASE("zero and tiny quaternions") {
        for (std::size_t row = 0; row < h.data.size(); ++row)
            for (std::size_t k = 0; k < 4; ++k)
                h.data.rotation[row * 4 + k] *= row % 3 == 0 ? 0.0f : row % 3 == 1 ? 1e-11f : 1e-30f;
    }
    DOCTEST_SUBCASE("quaternions whose square overflows") {
        for (std::size_t row = 0; row < h.data.size(); ++row)
            for (std::size_t k = 0; k < 4; ++k) h.data.rotation[row * 4 + k] *= row % 2 == 0 ? 1e25f : 3e37f;
    }
    DOCTEST_SUBCASE("scales whose exponential overflows") {
        for (std::size_t row = 0; row < h.data.size(); row += 4) h.data.log_scale[row * 3 + row % 3] = 100.0f;
        h.data.log_scale[3] = h.data.log_scale[4] = h.data.log_scale[5] = 3e38f;
    }
    DOCTEST_SUBCASE("scales of nothing") {
        for (std::size_t row = 0; row < h.data.size(); row += 2) h.data.log_scale[row * 3] = -Inf;
        for (std::size_t axis = 0; axis < 3; ++axis) h.data.log_scale[axis] = -Inf;
    }
    DOCTEST_SUBCASE("no blur: points and lines vanish, the rest stays") {
        h.settings.blur_px2 = 0.0f;
        for (std::size_t row = 0; row < h.data.size(); row += 2) h.data.log_scale[row * 3] = -40.0f;
        for (std::size_t row = 0; row < h.data.size(); row += 4) h.data.log_scale[row * 3 + 1] = -40.0f;
    }
    DOCTEST_SUBCASE("opacity compensation of points") {
        h.settings.antialiased = true;
        for (std::size_t row = 0; row < h.data.size(); row += 2)
            for (std::size_t axis = 0; axis < 3; ++axis) h.data.log_scale[row * 3 + axis] = -40.0f;
    }
    DOCTEST_SUBCASE("needles") {
        for (std::size_t row = 0; row < h.data.size(); ++row) {
            h.data.log_scale[row * 3] = 2.0f;
            h.data.log_scale[row * 3 + 1] = h.data.log_scale[row * 3 + 2] = -12.0f;
        }
    }
    DOCTEST_SUBCASE("colours beyond any display") {
        for (float& value : h.data.sh) value *= 1e30f;
        h.compare = false;  // the differences are of the size of the values
    }
    survive(h);
}

DOCTEST_TEST_CASE("places where numbers get large or coincide") {
    Hostile h;
    DOCTEST_SUBCASE("far world") { move_world(h, {1e6, -1e6, 1e6}); }
    DOCTEST_SUBCASE("camera inside the splats") {
        h.settings.near_plane = 1e-6f;
        const Vec3 eye = h.camera.centre();
        Random random(7);
        for (std::size_t row = 0; row < h.data.size(); ++row)
            for (int axis = 0; axis < 3; ++axis)
                h.data.position[row * 3 + static_cast<std::size_t>(axis)] =
                    static_cast<float>(eye[axis] + 1e-3 * random.normal());
    }
    DOCTEST_SUBCASE("thousands of coincident splats") {
        h.data = test::random_scene({.count = 5000, .seed = 103, .log_scale = -1});
        std::fill(h.data.position.begin(), h.data.position.end(), 0.1f);
    }
    DOCTEST_SUBCASE("a wide wall of giants") {
        h.data = test::random_scene({.count = 400, .seed = 104, .log_scale = 4, .opacity = -3});
    }
    DOCTEST_SUBCASE("rows at the edge of float") {
        for (std::size_t row = 0; row < h.data.size(); row += 2)
            h.data.position[row * 3] = row % 4 == 0 ? 1e17f : -1e17f;
        for (std::size_t row = 0; row < h.data.size(); row += 2) h.data.log_scale[row * 3] = 29.0f;
    }
    survive(h);
}

}  // namespace hostile_scenes_test
