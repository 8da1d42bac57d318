// Benchmark of the rasterizer: wall and CPU time per view, work counts, error against the plain version.
#include "engine/raster/bench.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/clock.h"
#include "engine/base/process_memory.h"
#include "engine/raster/bench_tools.h"
#include "engine/raster/kernels.h"
#include "engine/raster/plain.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {
namespace {

/// Sums of one repetition over its views.
struct Round {
    double wall = 0, cpu = 0;
};

template <class Work> void time_into(Round& round, const Work& work) {
    const double wall = wall_seconds(), cpu = processor_seconds();
    work();
    round.wall += wall_seconds() - wall;
    round.cpu += processor_seconds() - cpu;
}

BenchTimes summarize(const std::vector<Round>& rounds, std::size_t views) {
    std::vector<double> wall, cpu;
    for (const Round& round : rounds) {
        wall.push_back(1e3 * round.wall / static_cast<double>(views));
        cpu.push_back(1e3 * round.cpu / static_cast<double>(views));
    }
    std::sort(wall.begin(), wall.end());
    std::sort(cpu.begin(), cpu.end());
    return {wall[wall.size() / 2], wall.front(), cpu[cpu.size() / 2], cpu.front()};
}

struct Case {
    const GaussianSpans& gaussians;
    const Camera& camera;
    const Settings& settings;
    const Image& d_colour;
};

void compare_with_plain(const Case& c, Rasterizer& fast, RasterBench& result) {
    ForwardOutput image, truth;
    Gradients found, expected;
    fast.forward(c.gaussians, c.camera, c.settings, image);
    fast.backward(c.d_colour, {}, 0, found);
    const auto plain = make_plain_rasterizer();
    plain->forward(c.gaussians, c.camera, c.settings, truth);
    plain->backward(c.d_colour, {}, 0, expected);
    double squares = 0;
    for (std::size_t i = 0; i < truth.colour.data.size(); ++i) {
        const double error =
            std::abs(static_cast<double>(image.colour.data[i]) - static_cast<double>(truth.colour.data[i]));
        squares += error * error;
        // A pair that one version blends and the other cuts is a matter of the last digit, not of accuracy.
        if (image.blended[i / 3] == truth.blended[i / 3])
            result.max_abs_error = std::max(result.max_abs_error, error);
    }
    const double mean_square = squares / static_cast<double>(truth.colour.data.size());
    result.psnr_db = -10 * std::log10(std::max(mean_square, 1e-30));
    result.gradient_error = std::max({relative_error(found.position, expected.position),
                                      relative_error(found.log_scale, expected.log_scale),
                                      relative_error(found.rotation, expected.rotation),
                                      relative_error(found.opacity_logit, expected.opacity_logit),
                                      relative_error(found.sh, expected.sh)});
}

std::size_t drawn_rows(Rasterizer& rasterizer, const GaussianSpans& gaussians, const Camera& camera,
                       const Image& d_colour) {
    ForwardOutput image;
    Gradients gradients;
    rasterizer.forward(gaussians, camera, {}, image);
    rasterizer.backward(d_colour, {}, 0, gradients);
    return static_cast<std::size_t>(std::count(gradients.visible.begin(), gradients.visible.end(), 1));
}

void compare_with_floor(const KernelFloor& floor, std::size_t sh_floats, RasterBench& result) {
    result.kernel_floor = floor;
    result.floor = floor_step(
        floor, {result.splats, sh_floats, result.pairs_reached, result.block_pairs, result.threads});
    const double least = result.floor.total();
    result.floor_ratio = (result.forward.wall_min_ms + result.backward.wall_min_ms) / least;
    result.floor_ratio_cpu =
        (result.forward.cpu_min_ms + result.backward.cpu_min_ms) / result.threads / least;
}

/// Work of one repetition, summed over its views.
struct Work {
    std::size_t pairs = 0, blended = 0, reached = 0, blocks = 0;

    void add(const ForwardOutput& image) {
        pairs += image.pairs;
        reached += image.pairs_reached;
        blocks += image.block_pairs;
        for (const std::int32_t count : image.blended) blended += static_cast<std::size_t>(count);
    }
};

/// Sets the times of both passes, milliseconds per view.
void set_times(RasterBench& result, const std::vector<Round>& forward, const std::vector<Round>& backward) {
    result.forward = summarize(forward, result.views);
    result.backward = summarize(backward, result.views);
    result.forward_ms = result.forward.wall_median_ms;
    result.backward_ms = result.backward.wall_median_ms;
    result.forward_min_ms = result.forward.wall_min_ms;
    result.backward_min_ms = result.backward.wall_min_ms;
}

/// Sets the work per view, and the processor time of a blended pair. The times must be set.
void set_work(RasterBench& result, const Work& work) {
    result.pairs = work.pairs / result.views;
    result.blended_pairs = work.blended / result.views;
    result.pairs_reached = work.reached / result.views;
    result.block_pairs = work.blocks / result.views;
    const double per_pair = 1e6 / std::max(1.0, static_cast<double>(result.blended_pairs));
    result.forward_ns_per_pair = result.forward.cpu_min_ms * per_pair;
    result.backward_ns_per_pair = result.backward.cpu_min_ms * per_pair;
}

}  // namespace

RasterBench bench_raster(const GaussianSpans& gaussians, std::span<const Camera> cameras,
                         const BenchSettings& settings) {
    GSE_CHECK(!cameras.empty() && settings.repetitions > 0);
    ThreadPool pool(settings.threads);
    const auto rasterizer = make_rasterizer_of(settings.kernels, pool);
    std::vector<Camera> views;
    for (const Camera& camera : cameras) views.push_back(camera.resized(settings.width, settings.height));
    const Image d_colour = noise_image(settings.width, settings.height);
    const Settings image_settings;
    ForwardOutput image;
    Gradients gradients;
    std::optional<FloorBench> floor;
    if (settings.floor && rasterizer->name() != "cuda")
        floor.emplace(choose_kernels(settings.kernels.c_str()), pool,
                      drawn_rows(*rasterizer, gaussians, views.back(), d_colour));
    std::vector<Round> forward, backward;
    Work work;
    for (int round = -1; round < settings.repetitions; ++round) {  // round -1 warms up
        Round forward_round, backward_round;
        work = {};
        if (floor) {  // empties the caches, in which a loop of pictures finds its own buffers
            floor->measure();
            rasterizer->forward(gaussians, views.back(), image_settings, image);
            rasterizer->backward(d_colour, {}, 0, gradients);
        }
        for (const Camera& view : views) {
            time_into(forward_round, [&] { rasterizer->forward(gaussians, view, image_settings, image); });
            time_into(backward_round, [&] { rasterizer->backward(d_colour, {}, 0, gradients); });
            work.add(image);
        }
        if (round < 0) continue;
        forward.push_back(forward_round);
        backward.push_back(backward_round);
    }
    RasterBench result;
    result.kernels = rasterizer->name();
    result.threads = pool.thread_count();
    result.splats = gaussians.size;
    result.width = settings.width, result.height = settings.height;
    result.views = views.size();
    set_times(result, forward, backward);
    set_work(result, work);
    if (floor)
        compare_with_floor(floor->least(),
                           static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3, result);
    result.peak_rss_mb = peak_rss_mb();
    if (settings.compare_plain)
        compare_with_plain({gaussians, views.front(), image_settings, d_colour}, *rasterizer, result);
    return result;
}

}  // namespace gse::raster
