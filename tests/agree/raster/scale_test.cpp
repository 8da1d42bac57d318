// Scenes of any size: the near plane follows scene and camera, and nothing else of the image knows about
// world units.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/scene/depth_range.h"
#include "engine/scene/scene.h"
#include "tests/agree/raster/scenes.h"

namespace scale_test {

using namespace gse;
using namespace gse::raster;

namespace {

constexpr double Scales[] = {1e-5, 1e-3, 1e-2, 1, 1e3, 1e4, 1e6};
// Positions and log-scales of a scaled scene are rounded to float anew; opaque edges multiply that.
constexpr double ScaleTolerance = 2e-3, MeanScaleTolerance = 2e-5;

double mean_error(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        sum += std::abs(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]));
    return sum / static_cast<double>(a.data.size());
}

double mean_alpha(const ForwardOutput& output) {
    double sum = 0;
    for (const float value : output.alpha.data) sum += static_cast<double>(value);
    return sum / static_cast<double>(output.alpha.data.size());
}

/// The picture from the fitted orbit, as the commands take it.
ForwardOutput seen(const GaussianData& data, Rasterizer& rasterizer) {
    const GaussianSet set(data);
    const OrbitParameters orbit = fit_orbit(compute_statistics(set), {0, -1, 0});
    ForwardOutput output;
    rasterizer.forward(set.spans(), orbit_camera(orbit, 0.5, 64, 48), {}, output);
    return output;
}

}  // namespace

DOCTEST_TEST_CASE("a scene of any size gives the same picture") {
    ThreadPool pool(2);
    const auto plain = make_plain_rasterizer();
    const auto fast = make_fast_rasterizer(pool);
    const GaussianData data = test::random_scene({.count = 600, .seed = 41});
    for (const double distance : {4.0, 0.8}) {  // from outside, and from among the splats
        const Camera camera = test::test_camera(80, 60, distance);
        const auto ambiguous = test::ambiguous_pixels(data, camera, {});
        ForwardOutput truth;
        plain->forward(spans(data), camera, {}, truth);
        DOCTEST_REQUIRE(mean_alpha(truth) > 0.2);
        for (const double scale : Scales) {
            DOCTEST_CAPTURE(distance);
            DOCTEST_CAPTURE(scale);
            const GaussianData large = test::scaled(data, scale);
            for (Rasterizer* rasterizer : {plain.get(), fast.get()}) {
                ForwardOutput output;
                rasterizer->forward(spans(large), test::scaled(camera, scale), {}, output);
                DOCTEST_CHECK(test::clear_error(output.colour.data, truth.colour.data, ambiguous) <
                              ScaleTolerance);
                DOCTEST_CHECK(mean_error(output.colour, truth.colour) < MeanScaleTolerance);
            }
        }
    }
}

DOCTEST_TEST_CASE("the fitted orbit shows scenes of any size alike") {
    ThreadPool pool(2);
    const auto fast = make_fast_rasterizer(pool);
    const GaussianData data = test::random_scene({.count = 600, .seed = 42});
    const ForwardOutput truth = seen(data, *fast);
    DOCTEST_REQUIRE(mean_alpha(truth) > 0.05);
    for (const double scale : Scales) {
        DOCTEST_CAPTURE(scale);
        DOCTEST_CHECK(mean_error(seen(test::scaled(data, scale), *fast).colour, truth.colour) <
                      MeanScaleTolerance);
    }
}

DOCTEST_TEST_CASE("a single splat and splats that are all in one place are seen, however large") {
    ThreadPool pool(2);
    const auto fast = make_fast_rasterizer(pool);
    for (const std::size_t count : {1, 500})
        for (const double scale : Scales)
            for (const float place : {0.0f, 0.7f}) {
                DOCTEST_CAPTURE(count);
                DOCTEST_CAPTURE(scale);
                GaussianData data =
                    test::random_scene({.count = count, .seed = 43, .opacity = 4, .opacity_spread = 0});
                std::fill(data.position.begin(), data.position.end(), place);
                const ForwardOutput output = seen(test::scaled(data, scale), *fast);
                DOCTEST_CHECK(output.alpha.at(32, 24, 0) > 0.9f);
                DOCTEST_CHECK(mean_alpha(output) >
                              0.005);  // a spot of the picture, not a pixel, however thin the splat
                if (count == 1) DOCTEST_CHECK(mean_alpha(output) < 0.5);
            }
}

DOCTEST_TEST_CASE("a plane that is given stays where it is") {
    ThreadPool pool(2);
    const GaussianData data = test::random_scene({.count = 300, .seed = 44});
    const Camera camera = test::test_camera(48, 48, 4);
    const double depth = length(camera.centre());
    Settings settings;
    DOCTEST_SUBCASE("near") { settings.near_plane = static_cast<float>(depth); }
    DOCTEST_SUBCASE("far") { settings.far_plane = static_cast<float>(depth); }
    for (const bool plain : {false, true}) {
        const auto rasterizer = plain ? make_plain_rasterizer() : make_fast_rasterizer(pool);
        ForwardOutput output;
        rasterizer->forward(spans(data), camera, settings, output);
        std::vector<double> masked(data.size()), total(data.size());
        rasterizer->contributions(spans(data), camera, settings, Image(48, 48, 1, 1.0f), masked, total);
        std::size_t seen_rows = 0;
        for (std::size_t row = 0; row < data.size(); ++row) {
            const double z = camera
                                 .to_camera({data.position[row * 3], data.position[row * 3 + 1],
                                             data.position[row * 3 + 2]})
                                 .z;
            const bool cut = settings.near_plane > 0 ? z <= depth : z >= depth;
            if (cut) DOCTEST_CHECK(total[row] == 0);
            seen_rows += total[row] > 0 ? 1 : 0;
        }
        DOCTEST_CHECK(seen_rows > 20);
    }
}

}  // namespace scale_test
