// Times the preview's two ways of making a picture and measures how far they are from each other and from the
// truth.
#include "engine/laboratory/bench/raster/preview_bench.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "engine/base/process_memory.h"
#include "engine/math/quantile.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/preview/resolve.h"
#include "engine/preview/splat_renderer.h"
#include "engine/raster/rasterizer.h"
#include "engine/vulkan/device.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_usec) * 1e-3;
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

double wall_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

double median(std::vector<double> values) { return values.empty() ? 0 : upper_median(values); }

/// Times of the frames of one renderer.
struct Times {
    std::vector<double> wall, cpu;
    template <class Body> void measure(Body&& body) {
        const double wall_before = wall_ms(), cpu_before = cpu_ms();
        body();
        wall.push_back(wall_ms() - wall_before);
        cpu.push_back(cpu_ms() - cpu_before);
    }
    Json json() const {
        const auto summary = [](const std::vector<double>& all) -> Json {
            return {{"median", median(all)},
                    {"max", *std::max_element(all.begin(), all.end())},
                    {"min", *std::min_element(all.begin(), all.end())}};
        };
        Json json;
        json["wall_ms"] = summary(wall);
        json["cpu_ms"] = summary(cpu);
        json["cpu_ms_over_2"] = median(cpu) / 2;  // two cores at once
        json["frames_per_second"] = 1e3 / median(wall);
        return json;
    }
};

struct Error2 {
    double psnr_db = 0, max_abs = 0;
};

/// Error over red, green and blue of pictures with different numbers of channels.
Error2 difference(const Image& a, const Image& b) {
    double squares = 0, worst = 0;
    for (std::size_t pixel = 0; pixel < a.pixel_count(); ++pixel)
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = static_cast<double>(a.data[pixel * static_cast<std::size_t>(a.channels) + k]) -
                             static_cast<double>(b.data[pixel * static_cast<std::size_t>(b.channels) + k]);
            squares += d * d;
            worst = std::max(worst, std::abs(d));
        }
    const double mean = squares / static_cast<double>(a.pixel_count() * 3);
    return {mean > 0 ? -10 * std::log10(mean) : 200.0, worst};
}

Json error_json(const Error2& error) { return {{"psnr_db", error.psnr_db}, {"max_abs", error.max_abs}}; }

/// Draws with Vulkan and keeps the sums of the first frame.
class VulkanBench {
public:
    VulkanBench(const Scene& scene, bool validation)
        : instance_(vulkan::InstanceOptions{.extensions = {}, .validation = validation}), device_(instance_),
          renderer_(device_) {
        const double start = wall_ms();
        renderer_.upload(scene.gaussians);
        renderer_.finish_upload();
        upload_ms_ = wall_ms() - start;
    }

    void draw(const preview::FrameRequest& request) {
        for (int attempt = 0; attempt < 4; ++attempt) {
            device_.run([&](vk::raii::CommandBuffer& commands) {
                renderer_.render(static_cast<VkCommandBuffer>(*commands), request);
            });
            if (!renderer_.incomplete()) return;
        }
    }

    void note_frame() {
        const auto statistics = renderer_.statistics();
        for (const auto& [name, ms] : statistics.pass_ms) pass_ms_[name].push_back(ms);
        visible_ = std::max(visible_, statistics.visible);
        pairs_ = std::max(pairs_, statistics.pairs);
        dropped_ += statistics.dropped_pairs + statistics.unfinished_rows;
    }

    Json json(const Times& times) {
        Json json = times.json();
        json["device"] = device_.info().name;
        json["upload_ms"] = upload_ms_;
        json["device_mb"] = static_cast<double>(renderer_.device_bytes()) / 1048576.0;
        json["visible_splats"] = visible_;
        json["tile_pairs"] = pairs_;
        json["dropped"] = dropped_;
        for (const auto& [name, ms] : pass_ms_) json["pass_ms"][name] = median(ms);
        if (instance_.validates()) json["validation_messages"] = instance_.message_count();
        return json;
    }

    preview::SplatRenderer& renderer() { return renderer_; }

private:
    vulkan::Instance instance_;
    vulkan::Device device_;
    preview::SplatRenderer renderer_;
    double upload_ms_ = 0;
    std::map<std::string, std::vector<double>> pass_ms_;
    std::uint32_t visible_ = 0;
    std::uint64_t pairs_ = 0, dropped_ = 0;
};

preview::FrameRequest frame_request(const Camera& camera) {
    preview::FrameRequest request;
    request.camera = camera;
    return request;
}

Json bench_vulkan(const Scene& scene, const PreviewBenchOptions& options, const std::vector<Camera>& views,
                  pipeline::Painter& painter, std::optional<Image>& first_light) {
    VulkanBench bench(scene, options.validation);
    for (const auto& view : views) {  // to warm up: buffers grow in the first picture of each view
        bench.renderer().invalidate();
        bench.draw(frame_request(view));
    }
    Times times;
    Error2 worst{1e9, 0};
    for (const auto& view : views) {
        bench.renderer().invalidate();
        times.measure([&] { bench.draw(frame_request(view)); });
        bench.note_frame();
    }
    for (const auto& view : views) {
        const Image light = bench.renderer().draw_light(frame_request(view));
        if (!first_light) first_light = light;
        const auto error = difference(light, painter.paint(scene.gaussians.spans(), view, {}).colour);
        worst = {std::min(worst.psnr_db, error.psnr_db), std::max(worst.max_abs, error.max_abs)};
    }
    Json json = bench.json(times);
    json["against_native"] = error_json(worst);
    return json;
}

Json bench_native(const Scene& scene, const std::vector<Camera>& views, pipeline::Painter& painter) {
    Times times;
    std::vector<std::uint8_t> rgba;
    const preview::Display display;
    const auto draw = [&](const Camera& camera) {
        const auto& output = painter.paint(scene.gaussians.spans(), camera, {});
        preview::resolve({&output.colour, &output.alpha}, display, 1, painter.pool(), rgba);
    };
    for (const auto& view : views) draw(view);  // to warm up
    for (const auto& view : views) times.measure([&] { draw(view); });
    Json json = times.json();
    json["kernels"] = painter.rasterizer().name();
    return json;
}

}  // namespace

Json bench_preview(const Scene& scene, const PreviewBenchOptions& options) {
    auto views = options.cameras;
    if (views.empty())
        for (const auto& view :
             orbit_views(pipeline::scene_orbit(scene, {}), options.frames, options.width, options.height))
            views.push_back(view.camera);
    Json json;
    json["splats"] = scene.gaussians.size();
    json["sh_degree"] = scene.gaussians.sh_degree();
    json["width"] = options.width;
    json["height"] = options.height;
    json["frames"] = views.size();
    pipeline::Painter painter;
    std::optional<Image> vulkan_light;
    if (options.backend != "native")
        json["vulkan"] = bench_vulkan(scene, options, views, painter, vulkan_light);
    if (options.backend != "vulkan") json["native"] = bench_native(scene, views, painter);
    if (options.compare_plain) {
        raster::ForwardOutput truth;
        raster::make_plain_rasterizer()->forward(scene.gaussians.spans(), views[0], {}, truth);
        if (vulkan_light)
            json["vulkan"]["against_double"] = error_json(difference(*vulkan_light, truth.colour));
        if (json.contains("native"))
            json["native"]["against_double"] = error_json(
                difference(painter.paint(scene.gaussians.spans(), views[0], {}).colour, truth.colour));
    }
    json["peak_rss_mb"] = peak_rss_mb();
    return json;
}

}  // namespace gse::bench
