// The benchmark: it runs, its work counts are those of the renders, and the fast version's error is small.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/raster/bench.h"
#include "engine/raster/skip_bench.h"
#include "tests/agree/raster/scenes.h"

using namespace gse;

DOCTEST_TEST_CASE("the raster bench measures time and error") {
    const GaussianData data = test::random_scene({.count = 500, .seed = 111});
    const std::vector<Camera> cameras = {test::test_camera(64, 48), test::test_camera(64, 48, 5.0)};
    raster::BenchSettings settings;
    settings.width = 64;
    settings.height = 48;
    settings.repetitions = 2;
    settings.threads = 2;
    const raster::RasterBench bench = raster::bench_raster(spans(data), cameras, settings);
    DOCTEST_CHECK(bench.splats == 500);
    DOCTEST_CHECK(bench.views == 2);
    DOCTEST_CHECK(bench.threads == 2);
    DOCTEST_CHECK(bench.forward_ms > 0);
    DOCTEST_CHECK(bench.backward_ms >= bench.backward_min_ms);
    DOCTEST_CHECK(bench.pairs > 0);
    DOCTEST_CHECK(bench.blended_pairs > bench.pairs);
    DOCTEST_CHECK(bench.peak_rss_mb > 1);
    DOCTEST_CHECK(bench.psnr_db > 90);  // float against double: about 120 dB
    DOCTEST_CHECK(bench.max_abs_error < 1e-4);
    DOCTEST_CHECK(bench.gradient_error < 1e-2);
}

DOCTEST_TEST_CASE("the bench of the skips compares what it times, and the skips change nothing") {
    const GaussianData data = test::random_scene({.count = 800, .seed = 112, .log_scale = -3.5});
    const std::vector<Camera> cameras = {test::test_camera(64, 48), test::test_camera(64, 48, 5.0)};
    raster::BenchSettings settings;
    settings.width = 64;
    settings.height = 48;
    settings.repetitions = 3;
    settings.threads = 2;
    const double shares[] = {0.05, 1.0};
    const auto benches = raster::bench_skips(spans(data), cameras, settings, shares);
    DOCTEST_REQUIRE(benches.size() == 2);
    for (const auto& bench : benches) {
        DOCTEST_CHECK(bench.full.forward_ms > 0);
        DOCTEST_CHECK(bench.ratio > 0);
        DOCTEST_CHECK(bench.picture_difference == 0);
        DOCTEST_CHECK(bench.gradient_difference == 0);
        DOCTEST_CHECK(bench.pairs > 0);
    }
    DOCTEST_CHECK(benches[0].labelled == 40);
    DOCTEST_CHECK(benches[0].pairs < benches[0].full_pairs);
    DOCTEST_CHECK(benches[0].kept_mib > 0);
    DOCTEST_CHECK(benches[1].labelled == 800);
    DOCTEST_CHECK(benches[1].pairs == benches[1].full_pairs);   // nothing stays: rendered in full
    DOCTEST_CHECK(benches[1].kept_mib == 0);
}
