// The scenes of engine/laboratory/synth/timing_scene.h through the rasterizer's and the preview's benches.
#include "engine/laboratory/bench/raster/speed_bench.h"

#include <fmt/format.h>

#include "engine/io/cameras/cameras.h"
#include "engine/io/scene/scene_file.h"
#include "engine/laboratory/bench/raster/floor_cases.h"
#include "engine/laboratory/bench/raster/raster_report.h"
#include "engine/laboratory/synth/timing_scene.h"
#include "engine/raster/bench.h"
#ifdef GSE_WINDOW
#include "engine/laboratory/bench/raster/preview_bench.h"
#endif

namespace gse::bench {
namespace {

/// 100000 -> "100,000".
std::string grouped(std::size_t value) {
    std::string text = std::to_string(value);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
    return text;
}

struct Row {
    std::string what, picture;
    std::size_t splats = 0;
    double cpu_ms = 0;
    std::string error;
};

std::string line(const Row& row) {
    return fmt::format("| {} | {} | {} | {:.0f} ms | {} |\n", row.what, grouped(row.splats), row.picture,
                       row.cpu_ms, row.error);
}

std::string size_text(int width, int height) { return fmt::format("{} x {}", width, height); }

void write_scene(const SpeedBenchOptions& options, const Scene& scene, const std::vector<Camera>& cameras) {
    if (options.scenes_folder.empty()) return;
    const auto folder = options.scenes_folder / fmt::format("speed_{}", scene.gaussians.size());
    std::filesystem::create_directories(folder);
    save_scene(folder / "scene.ply", scene, {});
    std::vector<View> views;
    for (const Camera& camera : cameras) views.push_back({fmt::format("circle_{:02}", views.size()), camera});
    save_cameras_json(folder / "cameras.json", views);
}

std::string raster_lines(const SpeedBenchOptions& options, const Scene& scene, std::string& kernels,
                         std::string& floors) {
    raster::BenchSettings settings;
    settings.width = options.raster_width;
    settings.height = options.raster_height;
    settings.repetitions = options.repetitions;
    settings.floor = true;
    const auto cameras = synth::timing_cameras(options.views, settings.width, settings.height);
    write_scene(options, scene, cameras);
    const auto bench = raster::bench_raster(scene.gaussians.spans(), cameras, settings);
    kernels = fmt::format("{} kernels, {} threads", bench.kernels, bench.threads);
    const auto picture = size_text(settings.width, settings.height);
    floors += fmt::format("- {} splats, {}:\n  {}.\n", grouped(bench.splats), picture,
                          floor_text(floor_report(bench)));
    return line({"rasterizer, forward", picture, bench.splats, bench.forward.cpu_median_ms,
                 fmt::format("{:.0f} dB, largest {:.1e}", bench.psnr_db, bench.max_abs_error)}) +
           line({"rasterizer, backward", picture, bench.splats, bench.backward.cpu_median_ms,
                 fmt::format("{:.1e} of the gradient", bench.gradient_error)});
}

#ifdef GSE_WINDOW
std::string preview_lines(const SpeedBenchOptions& options, const Scene& scene) {
    PreviewBenchOptions preview;
    preview.width = options.preview_width;
    preview.height = options.preview_height;
    preview.cameras = synth::timing_cameras(options.views, preview.width, preview.height);
    const auto json = bench_preview(scene, preview);
    const auto row = [&](const char* renderer, const std::string& name) {
        const auto& figures = json.at(renderer);
        return line({name, size_text(preview.width, preview.height), scene.gaussians.size(),
                     figures.at("cpu_ms").at("median").get<double>(),
                     fmt::format("{:.0f} dB", figures.at("against_double").at("psnr_db").get<double>())});
    };
    return row("native", "preview, own rasterizer") +
           row("vulkan", "preview, Vulkan compute on " + json.at("vulkan").at("device").get<std::string>());
}
#endif

}  // namespace

std::string speed_table(const SpeedBenchOptions& options) {
    std::string rows, kernels, floors;
    for (const std::size_t count : options.splats) {
        const Scene scene = synth::timing_scene(count, options.seed);
        rows += raster_lines(options, scene, kernels, floors);
#ifdef GSE_WINDOW
        rows += preview_lines(options, scene);
#endif
    }
    return fmt::format(
        "Scenes of seed {}, SH degree 3, {} cameras on a circle, {}.\n"
        "Median processor time of a picture, all threads together.\n\n"
        "| what | splats | picture | processor time | error against double precision "
        "|\n|---|---|---|---|---|\n{}\n{}",
        options.seed, options.views, kernels, rows, floors);
}

}  // namespace gse::bench
