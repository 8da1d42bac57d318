// The preview against the rasterizers: same scenes, same cameras, same pictures.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>

#include "engine/preview/resolve.h"
#include "engine/preview/splat_renderer.h"
#include "tests/agree/preview/device.h"
#include "tests/agree/raster/scenes.h"

namespace pictures_test {

using namespace gse;

namespace {

// Colours and spherical harmonics are halfs on the way (2^-11 relative each), exp2 is the device's (llvmpipe:
// 1e-5 relative).
constexpr double SmallestPsnr = 55;
constexpr double LargestError = 4e-3;       // colours up to about 3 here; off ambiguous pixels
constexpr double LargestAlphaError = 1e-3;  // alpha does not pass through halfs
constexpr double LargestDepthError = 4e-3;  // depths up to about 6

struct Difference {
    double psnr = 0, colour = 0, alpha = 0, depth = 0, value = 0;
};

Difference compare(const Image& light, const raster::ForwardOutput& truth, const Image* values,
                   const std::vector<std::uint8_t>& ambiguous) {
    Difference result;
    double squares = 0;
    for (std::size_t pixel = 0; pixel < ambiguous.size(); ++pixel) {
        const float* found = &light.data[pixel * 6];
        for (std::size_t k = 0; k < 3; ++k) {
            const double error = std::abs(static_cast<double>(found[k]) - truth.colour.data[pixel * 3 + k]);
            squares += error * error;
            if (ambiguous[pixel] == 0) result.colour = std::max(result.colour, error);
        }
        if (ambiguous[pixel] != 0) continue;
        const auto error = [&](std::size_t k, float wanted) {
            return std::abs(static_cast<double>(found[k]) - wanted);
        };
        result.alpha = std::max(result.alpha, error(3, truth.alpha.data[pixel]));
        result.depth = std::max(result.depth, error(4, truth.depth.data[pixel]));
        if (values != nullptr) result.value = std::max(result.value, error(5, values->data[pixel]));
    }
    result.psnr = squares > 0 ? -10 * std::log10(squares / static_cast<double>(ambiguous.size() * 3)) : 200;
    return result;
}

struct Case {
    const char* name;
    test::SceneRecipe recipe;
    int width, height;
    bool antialiased = false;
    int used_degree = 3;
};

void check_case(vulkan::Device& device, const Case& one, const preview::RendererOptions& options) {
    DOCTEST_CAPTURE(one.name);
    const GaussianData data = test::random_scene(one.recipe);
    const GaussianSet set{data};
    const Camera camera = test::test_camera(one.width, one.height);
    raster::Settings settings;
    settings.antialiased = one.antialiased;
    settings.sh_degree = one.used_degree;
    const auto plain = raster::make_plain_rasterizer();
    raster::ForwardOutput truth;
    plain->forward(set.spans(), camera, settings, truth);
    auto values = std::make_shared<std::vector<float>>(set.size());
    for (std::size_t row = 0; row < set.size(); ++row) (*values)[row] = static_cast<float>(row % 5) / 4;
    Image value_sum;
    plain->forward_values(set.spans(), camera, settings, *values, value_sum);

    preview::SplatRenderer renderer(device, options);
    renderer.upload(set);
    renderer.finish_upload();
    renderer.set_values(values);
    preview::FrameRequest request;
    request.camera = camera;
    request.display.antialiased = one.antialiased;
    request.display.sh_degree = one.used_degree;
    const Image light = renderer.draw_light(request);
    const auto difference = compare(light, truth, &value_sum, test::ambiguous_pixels(data, camera, settings));
    DOCTEST_CAPTURE(difference.psnr);
    DOCTEST_CHECK(difference.psnr >= SmallestPsnr);
    DOCTEST_CHECK(difference.colour <= LargestError);
    DOCTEST_CHECK(difference.alpha <= LargestAlphaError);
    DOCTEST_CHECK(difference.depth <= LargestDepthError);
    DOCTEST_CHECK(difference.value <= LargestAlphaError);
    DOCTEST_CHECK(renderer.statistics().dropped_pairs == 0);
}

const Case Cases[] = {
    {"SH 0, whole tiles", {.count = 300, .sh_degree = 0}, 128, 64},
    {"SH 1, odd size", {.count = 300, .seed = 2, .sh_degree = 1}, 101, 67},
    {"SH 2", {.count = 500, .seed = 3, .sh_degree = 2}, 97, 131},
    {"SH 3", {.count = 2000, .seed = 4}, 160, 120},
    {"SH 3 shown as 1", {.count = 300, .seed = 5}, 96, 64, false, 1},
    {"SH 3 shown as 0", {.count = 300, .seed = 5}, 96, 64, false, 0},
    {"compensated opacity", {.count = 500, .seed = 6, .log_scale = -4}, 120, 90, true},
    {"needles", {.count = 400, .seed = 7, .stretch = 3}, 120, 90},
    {"large splats", {.count = 200, .seed = 8, .log_scale = 0}, 120, 90},
    {"opaque", {.count = 3000, .seed = 9, .opacity = 6}, 120, 90},
    {"faint", {.count = 3000, .seed = 10, .opacity = -4}, 120, 90},
    {"many small ones", {.count = 30000, .seed = 13, .sh_degree = 1, .log_scale = -4.5}, 200, 150},
    {"one splat", {.count = 1, .seed = 11, .log_scale = -1, .opacity = 3}, 64, 48},
    {"one pixel", {.count = 300, .seed = 12}, 1, 1},
};

}  // namespace

DOCTEST_TEST_CASE("the preview agrees with the plain rasterizer") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    for (const bool portable : {false, true}) {
        DOCTEST_CAPTURE(portable);
        for (const auto& one : Cases) check_case(*shared->device, one, {.portable_blend = portable});
    }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("the division of work for a GPU gives the same pictures") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    for (const std::size_t i : {1u, 3u, 8u, 11u})
        check_case(*shared->device, Cases[i], {.portable_blend = true, .many_parts = true});
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("uploads through staging memory and pair lists that grow change nothing") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    check_case(*shared->device, Cases[3], {.always_stage = true});
    check_case(*shared->device, Cases[8], {.pair_capacity = 1024});
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("nothing to draw gives the background") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    preview::FrameRequest request;
    request.camera = test::test_camera(50, 40);
    request.display.background = {1.0f, 0.2f, 0.0f};
    const auto check = [&](preview::SplatRenderer& renderer) {
        const Image image = renderer.draw(request);
        for (int k = 0; k < 4; ++k)
            DOCTEST_CHECK(
                image.at(49, 39, k) ==
                doctest::Approx(k == 3 ? 1.0f : request.display.background[static_cast<std::size_t>(k)]));
        DOCTEST_CHECK(!renderer.pick(20, 20).has_value());
    };
    preview::SplatRenderer never(*shared->device);
    check(never);
    preview::SplatRenderer empty(*shared->device);
    empty.upload(GaussianSet{});
    check(empty);
    preview::SplatRenderer behind(*shared->device);
    GaussianData data = test::random_scene({.count = 50});
    for (std::size_t row = 0; row < data.size(); ++row) {
        const Vec3 place =
            request.camera.centre() - request.camera.forward() * (3.0 + static_cast<double>(row));
        for (int axis = 0; axis < 3; ++axis)
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(place[axis]);
    }
    behind.upload(GaussianSet{data});
    check(behind);
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("display modes look the same on the device and on the CPU") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    constexpr double LargestByteError = 1.01 / 255;  // rounding may fall the other way
    const GaussianSet set{test::random_scene({.count = 400, .seed = 21, .sh_degree = 1})};
    auto values = std::make_shared<std::vector<float>>(set.size());
    for (std::size_t row = 0; row < set.size(); ++row) (*values)[row] = row % 3 == 0 ? 1.0f : 0.0f;
    preview::SplatRenderer renderer(*shared->device);
    renderer.upload(set);
    renderer.finish_upload();
    renderer.set_values(values);
    ThreadPool pool(2);
    preview::FrameRequest request;
    request.camera = test::test_camera(90, 70);
    for (const auto mode :
         {preview::Mode::Beauty, preview::Mode::Depth, preview::Mode::Opacity, preview::Mode::Labels,
          preview::Mode::LabelWeight, preview::Mode::Attention, preview::Mode::Changed})
        for (const bool transparent : {false, true}) {
            request.display.mode = mode;
            request.display.transparent = transparent;
            request.display.tint_strength = mode == preview::Mode::Labels ? 0.7f : 0.0f;
            request.display.background = {0.1f, 0.3f, 0.6f};
            request.display.depth_scale = 4;
            const Image shown = renderer.draw(request), light = renderer.draw_light(request);
            Image colour(90, 70, 3), alpha(90, 70, 1), depth(90, 70, 1), value(90, 70, 1);
            for (std::size_t i = 0; i < alpha.data.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) colour.data[i * 3 + k] = light.data[i * 6 + k];
                alpha.data[i] = light.data[i * 6 + 3];
                depth.data[i] = light.data[i * 6 + 4];
                value.data[i] = light.data[i * 6 + 5];
            }
            std::vector<std::uint8_t> bytes;
            preview::resolve({&colour, &alpha, &depth, &value}, request.display, 4, pool, bytes);
            double worst = 0;
            for (std::size_t i = 0; i < bytes.size(); ++i)
                worst = std::max(worst, std::abs(static_cast<double>(shown.data[i]) - bytes[i] / 255.0));
            DOCTEST_CAPTURE(static_cast<int>(mode));
            DOCTEST_CHECK(worst <= LargestByteError);
        }
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

}  // namespace pictures_test
