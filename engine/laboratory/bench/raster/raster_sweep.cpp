// Every instruction set with every number of threads over one scene.
#include "engine/laboratory/bench/raster/raster_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/thread_pool.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/bench/raster/floor_cases.h"
#include "engine/laboratory/synth/timing_scene.h"
#include "engine/raster/bench.h"
#include "engine/raster/rasterizer.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Facet>& raster_facets() {
    static const std::vector<Facet> facets{
        {"forward_ms", "max_abs_error", "ms per picture, forward",
         "largest error of a pixel (display value 0 to 1)", true, ChartScale::Logarithmic, "Forward"},
        {"backward_ms", "gradient_error", "ms per picture, backward", "relative error of the gradient (L2)",
         true, ChartScale::Logarithmic, "Backward"}};
    return facets;
}

/// One thread of the double version over the first view, milliseconds.
Json time_plain(const Scene& scene, const Camera& camera) {
    using Clock = std::chrono::steady_clock;
    const auto plain = raster::make_plain_rasterizer();
    raster::ForwardOutput picture;
    raster::Gradients gradients;
    const auto start = Clock::now();
    plain->forward(scene.gaussians.spans(), camera, {}, picture);
    const auto between = Clock::now();
    plain->backward(picture.colour, {}, 0, gradients);
    const auto end = Clock::now();
    const auto ms = [](auto from, auto to) {
        return std::chrono::duration<double, std::milli>(to - from).count();
    };
    return {{"forward_ms", ms(start, between)}, {"backward_ms", ms(between, end)}};
}

SettingPoint raster_point(const raster::RasterBench& bench, const raster::RasterBench& compared) {
    SettingPoint point{bench.kernels,
                       fmt::format("{} thread{}", bench.threads, bench.threads == 1 ? "" : "s"),
                       false,
                       {},
                       {}};
    point.settings = {{"kernels", bench.kernels}, {"threads", bench.threads}};
    point.figures = {
        {"forward_ms", bench.forward_min_ms},         {"backward_ms", bench.backward_min_ms},
        {"forward_cpu_ms", bench.forward.cpu_min_ms}, {"backward_cpu_ms", bench.backward.cpu_min_ms},
        {"max_abs_error", compared.max_abs_error},    {"psnr_db", compared.psnr_db},
        {"gradient_error", compared.gradient_error}};
    return point;
}

std::vector<SettingPoint> raster_points(const RasterSweepParameters& parameters, const Scene& scene,
                                        const std::vector<Camera>& cameras, const JobControl& job) {
    ThreadPool pool(0);
    const auto usual = raster::make_fast_rasterizer(pool)->name();
    auto counts = numbers_in_list("thread_counts", parameters.thread_counts, 1, 256);
    if (std::find(counts.begin(), counts.end(), pool.thread_count()) == counts.end())
        counts.push_back(pool.thread_count());
    const auto kernels = kernels_in_list(parameters.kernels);
    const int total = static_cast<int>(kernels.size() * counts.size());
    std::vector<SettingPoint> points;
    for (const auto& name : kernels) {
        raster::RasterBench compared;  // threads change no bit: the error is measured once
        for (const double count : counts) {
            if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            job.report("rasterizing", static_cast<int>(points.size()), total);
            raster::BenchSettings settings;
            settings.width = parameters.width, settings.height = parameters.height;
            settings.repetitions = parameters.repetitions;
            settings.threads = static_cast<unsigned>(count);
            settings.kernels = name;
            settings.compare_plain = compared.kernels.empty();
            const auto bench = raster::bench_raster(scene.gaussians.spans(), cameras, settings);
            if (compared.kernels.empty()) compared = bench;
            points.push_back(raster_point(bench, compared));
            points.back().standard = name == usual && bench.threads == pool.thread_count();
        }
    }
    return points;
}

}  // namespace

std::vector<std::string> kernels_in_list(const std::string& list) {
    const auto usable = raster::usable_kernels();
    std::vector<std::string> names;
    for (const auto& name : words_in_list(list)) {
        if (name == "all") {
            names.insert(names.end(), usable.begin(), usable.end());
            continue;
        }
        if (name == "cuda") raster::require_rasterizer(name);
        else if (std::find(usable.begin(), usable.end(), name) == usable.end())
            throw Error(ErrorCode::InvalidArgument, "the kernels \"" + name + "\" do not run here",
                        "use all, or some of scalar avx2 avx512 cuda");
        names.push_back(name);
    }
    if (names.empty())
        throw Error(ErrorCode::InvalidArgument, "no kernels are named",
                    "use all, or some of scalar avx2 avx512 cuda");
    return names;
}

Subject bench_raster_sweep(const RasterSweepParameters& parameters, const JobControl& job) {
    const auto floor_cases = floor_cases_in_list(parameters.floor_cases);
    const Scene scene = synth::timing_scene(static_cast<std::size_t>(parameters.splats), parameters.seed);
    const auto cameras = synth::timing_cameras(parameters.views, parameters.width, parameters.height);
    const auto points = raster_points(parameters, scene, cameras, job);
    const Json plain = time_plain(scene, cameras.front());
    Subject subject{"raster", "Rasterizer: error against time, by instruction set and threads", {}, {}, {},
                    {}};
    subject.report = {
        {"parameters", fields_to_json(parameters)}, {"plain", plain}, {"points", points_json(points)}};
    subject.report["fronts"] = fronts_of(points, raster_facets());
    subject.report["floor"] =
        bench_floor_cases(floor_cases, parameters.seed, parameters.views, parameters.repetitions, job);
    Chart chart;
    chart.title = subject.title;
    for (const auto& facet : raster_facets()) chart.panels.push_back(panel_of(points, facet));
    chart.notes = {
        fmt::format("{} splats, SH degree 3, {} x {} pixels, {} views; wall time, least of {} rounds. Error: "
                    "to the plain double "
                    "version, which takes {} ms forward and {} ms backward on one thread.",
                    number_text(parameters.splats), parameters.width, parameters.height, parameters.views,
                    parameters.repetitions, number_text(plain["forward_ms"].get<double>()),
                    number_text(plain["backward_ms"].get<double>())),
        "Threads change no bit of the result: points of one instruction set lie on one line."};
    subject.picture = draw_chart(chart);
    subject.tables = {points_table("", subject.report["points"],
                                   {{"forward_ms", "forward ms"},
                                    {"forward_cpu_ms", "processor ms"},
                                    {"max_abs_error", "largest error"},
                                    {"psnr_db", "dB"},
                                    {"backward_ms", "backward ms"},
                                    {"backward_cpu_ms", "processor ms"},
                                    {"gradient_error", "gradient error"}})};
    if (!floor_cases.empty()) subject.tables.push_back(floor_table(subject.report["floor"]));
    subject.remarks = front_remarks(subject.report["fronts"], {"Forward", "Backward"});
    return subject;
}

}  // namespace gse::bench
