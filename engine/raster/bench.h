// Times the rasterizer and measures its error against the plain double version, so that speed stands beside
// error.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "engine/math/camera.h"
#include "engine/raster/floor_bench.h"
#include "engine/scene/gaussian_set.h"

namespace gse::raster {

/// Median and minimum over the repetitions, milliseconds per view (mean over the views of one repetition).
struct BenchTimes {
    double wall_median_ms = 0, wall_min_ms = 0;
    double cpu_median_ms = 0, cpu_min_ms = 0;  // all threads together
};

struct RasterBench {
    std::string kernels;  // "avx512", "avx2", "scalar" or "cuda"
    unsigned threads = 0;
    std::size_t splats = 0;
    int width = 0, height = 0;
    std::size_t views = 0;
    double forward_ms = 0, backward_ms = 0;          // medians of the wall time
    double forward_min_ms = 0, backward_min_ms = 0;  // minima of the wall time
    BenchTimes forward, backward;
    std::size_t pairs = 0;                           // tile-Gaussian pairs per view (mean)
    std::size_t blended_pairs = 0;                   // pixel-Gaussian pairs blended per view (mean)
    std::size_t pairs_reached = 0, block_pairs = 0;  // ForwardOutput, per view (mean)
    // With BenchSettings::floor: the floor in the same run (floor_bench.h), and forward plus backward over
    // it: least wall time, and least processor time divided by the threads.
    KernelFloor kernel_floor;
    FloorStep floor;
    double floor_ratio = 0, floor_ratio_cpu = 0;
    double forward_ns_per_pair = 0;  // CPU time over blended pairs, minimum
    double backward_ns_per_pair = 0;
    double peak_rss_mb = 0;  // of the process, with 128 MiB for the floor
    // Against the plain version, first view; pixels where rounding may decide a cut otherwise are left out of
    // the maximum but not of the PSNR.
    double max_abs_error = 0;
    double psnr_db = 0;
    double gradient_error = 0;  // largest relative L2 over the tensors
};

struct BenchSettings {
    int width = 512, height = 512;
    int repetitions = 5;
    unsigned threads = 0;       // 0 = one per hardware thread
    std::string kernels;        // instruction set, or cuda; empty = the best
    bool compare_plain = true;  // the plain version takes seconds on large scenes
    bool floor = false;         // also measure the processor's floor, before every round; not for cuda
};

/// Runs the fast rasterizer on every camera (resized to the settings' size), after one round of warming up.
RasterBench bench_raster(const GaussianSpans& gaussians, std::span<const Camera> cameras,
                         const BenchSettings& settings);

}  // namespace gse::raster
