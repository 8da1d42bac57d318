// The benchmark: it runs, its work counts are those of the renders, and the fast version's error is small.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/raster/bench.h"
#include "engine/raster/rasterizer.h"
#include "engine/raster/skip_bench.h"
#include "tests/agree/raster/scenes.h"

namespace bench_test {

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
    DOCTEST_CHECK(bench.pairs_reached <= bench.pairs);
    DOCTEST_CHECK(bench.block_pairs >= bench.pairs_reached);
    DOCTEST_CHECK(bench.block_pairs <= 16 * bench.pairs_reached);
    DOCTEST_CHECK(16 * bench.block_pairs >= bench.blended_pairs);  // a block is 16 pixels
    DOCTEST_CHECK(bench.floor_ratio == 0);                         // was not asked for
}

DOCTEST_TEST_CASE("the raster bench measures the floor, with every instruction set and number of threads") {
    const GaussianData data = test::random_scene({.count = 300, .seed = 113});
    const std::vector<Camera> cameras = {test::test_camera(64, 48)};
    for (const auto& kernels : raster::usable_kernels())
        for (const unsigned threads : {1u, 3u}) {
            raster::BenchSettings settings;
            settings.width = 64, settings.height = 48;
            settings.repetitions = 1;
            settings.threads = threads;
            settings.kernels = kernels;
            settings.compare_plain = false;
            settings.floor = true;
            const auto bench = raster::bench_raster(spans(data), cameras, settings);
            const auto& floor = bench.kernel_floor;
            DOCTEST_CHECK(floor.forward_ns > 0);
            for (const double ns : floor.backward_ns) DOCTEST_CHECK(ns > 0);
            DOCTEST_CHECK(floor.mask_ns > 0);
            DOCTEST_CHECK(floor.gather_ns > 0);
            DOCTEST_CHECK(floor.scene_gather_ns > 0);
            DOCTEST_CHECK(floor.gigabytes_per_second > 0);
            DOCTEST_CHECK(bench.floor.total() > 0);
            DOCTEST_CHECK(bench.floor_ratio > 0);
            DOCTEST_CHECK(bench.floor_ratio_cpu > 0);
        }
}

DOCTEST_TEST_CASE("the floor is the counted work times the times of the loops") {
    raster::KernelFloor kernel;
    kernel.forward_ns = 6;
    kernel.backward_ns = {28, 20, 17, 15, 14};  // of 1, 2, 4, 8, 16 blocks
    kernel.mask_ns = 10, kernel.gather_ns = 1, kernel.scene_gather_ns = 5;
    kernel.gigabytes_per_second = 24;
    const auto step = [&](std::size_t pairs, std::size_t blocks) {
        return raster::floor_step(kernel, {100000, 48, pairs, blocks, 2});
    };
    const auto even = step(250000, 1000000);
    DOCTEST_CHECK(even.forward_blend == doctest::Approx(3));
    DOCTEST_CHECK(even.backward_blend == doctest::Approx(8.5));  // 4 blocks per pair
    DOCTEST_CHECK(even.lists == doctest::Approx(3.75));          // forward and backward
    DOCTEST_CHECK(even.lists_in_cache == doctest::Approx(2.75));
    DOCTEST_CHECK(even.parameters == doctest::Approx(236 * 0.1 / 24));  // bytes of 100,000 splats
    DOCTEST_CHECK(even.parameter_gradients == doctest::Approx(2 * even.parameters));
    DOCTEST_CHECK(even.total() == doctest::Approx(3 + 8.5 + 3.75 + 3 * even.parameters));
    DOCTEST_CHECK(step(1000000, 1000000).backward_blend == doctest::Approx(14));
    DOCTEST_CHECK(step(62500, 1000000).backward_blend == doctest::Approx(7));
    // 5 blocks: the sum of a pair, which grows by less than the blocks do.
    DOCTEST_CHECK(step(200000, 1000000).backward_blend == doctest::Approx(0.5 * (15 + (17 - 15) * 0.6)));
    DOCTEST_CHECK(step(0, 0).total() == doctest::Approx(3 * even.parameters));
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
    DOCTEST_CHECK(benches[1].pairs == benches[1].full_pairs);  // nothing stays: rendered in full
    DOCTEST_CHECK(benches[1].kept_mib == 0);
}

}  // namespace bench_test
