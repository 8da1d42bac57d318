// Spherical harmonics, opacity compensation and the size of moving pictures, with both renderers.
#include "engine/laboratory/bench/raster/preview_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "engine/base/error.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/bench/raster/turn_timer.h"
#include "engine/laboratory/synth/timing_scene.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/preview/moving_scale.h"
#include "engine/preview/resolve.h"
#include "engine/preview/splat_renderer.h"
#include "engine/raster/rasterizer.h"
#include "engine/vulkan/device.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Settings of drawing a picture.
struct PreviewSetting {
    int sh_degree = 3;
    bool antialiased = false;
    double scale = 1;  // of the full width and height
    bool full() const { return sh_degree == 3 && !antialiased && scale >= 1; }
};

std::string setting_name(const PreviewSetting& setting) {
    if (setting.full()) return "full";
    std::string name = setting.sh_degree < 3 ? fmt::format("SH {}", setting.sh_degree) : "";
    if (setting.antialiased) name += "antialiased";
    if (setting.scale < 1) name += fmt::format("{}size {:g}", name.empty() ? "" : ", ", setting.scale);
    return name;
}

/// One thing at a time away from the full picture, and the lowest quality of all.
std::vector<PreviewSetting> preview_settings(const PreviewSweepParameters& parameters) {
    std::vector<PreviewSetting> settings{{}};
    const auto degrees = numbers_in_list("sh_degrees", parameters.sh_degrees, 0, 3);
    const auto scales = numbers_in_list("scales", parameters.scales, 0.01, 1);
    for (const double degree : degrees)
        if (degree < 3) settings.push_back({static_cast<int>(degree), false, 1});
    settings.push_back({3, true, 1});
    for (const double scale : scales)
        if (scale < 1) settings.push_back({3, false, scale});
    if (!degrees.empty() && degrees.front() < 3 && !scales.empty() && scales.front() < 1)
        settings.push_back({static_cast<int>(degrees.front()), false, scales.front()});
    return settings;
}

/// Draws pictures, and gives the light of one, [h,w,channels >= 3], for the comparison.
class SweptRenderer {
public:
    virtual ~SweptRenderer() = default;
    virtual void draw(const Camera& camera, const PreviewSetting& setting) = 0;
    virtual Image light(const Camera& camera, const PreviewSetting& setting) = 0;
};

raster::Settings image_settings(const PreviewSetting& setting) {
    raster::Settings settings;
    settings.sh_degree = setting.sh_degree;
    settings.antialiased = setting.antialiased;
    return settings;
}

class NativeRenderer final : public SweptRenderer {
public:
    explicit NativeRenderer(const Scene& scene) : scene_(scene) {}
    void draw(const Camera& camera, const PreviewSetting& setting) override {
        const auto& output = painter_.paint(scene_.gaussians.spans(), camera, image_settings(setting));
        preview::resolve({&output.colour, &output.alpha}, {}, 1, painter_.pool(), rgba_);
    }
    Image light(const Camera& camera, const PreviewSetting& setting) override {
        return painter_.paint(scene_.gaussians.spans(), camera, image_settings(setting)).colour;
    }

private:
    const Scene& scene_;
    pipeline::Painter painter_;
    std::vector<std::uint8_t> rgba_;
};

class VulkanRenderer final : public SweptRenderer {
public:
    explicit VulkanRenderer(const Scene& scene) : device_(instance_), renderer_(device_) {
        renderer_.upload(scene.gaussians);
        renderer_.finish_upload();
    }
    void draw(const Camera& camera, const PreviewSetting& setting) override {
        constexpr int attempts = 4;  // of a picture that met more pairs than expected
        renderer_.invalidate();
        for (int i = 0; i < attempts; ++i) {
            device_.run([&](vk::raii::CommandBuffer& commands) {
                renderer_.render(static_cast<VkCommandBuffer>(*commands), request(camera, setting));
            });
            if (!renderer_.incomplete()) return;
        }
    }
    Image light(const Camera& camera, const PreviewSetting& setting) override {
        return renderer_.draw_light(request(camera, setting));
    }
    const vulkan::DeviceInfo& info() const { return device_.info(); }

private:
    static preview::FrameRequest request(const Camera& camera, const PreviewSetting& setting) {
        preview::FrameRequest request;
        request.camera = camera;
        request.display.sh_degree = setting.sh_degree;
        request.display.antialiased = setting.antialiased;
        return request;
    }
    vulkan::Instance instance_;
    vulkan::Device device_;
    preview::SplatRenderer renderer_;
};

/// Root mean square of the difference of red, green and blue; a smaller picture is shown as large as the
/// truth, as the window does.
double rms_error(const Image& shown, const Image& truth) {
    const Image full = localize::resize_image(shown, truth.width, truth.height);
    double squares = 0;
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double d =
                    static_cast<double>(full.at(x, y, c)) - static_cast<double>(truth.at(x, y, c));
                squares += d * d;
            }
    return std::sqrt(squares / (3.0 * static_cast<double>(truth.pixel_count())));
}

/// The double-precision pictures of the first view, without and with opacity compensation.
struct PreviewTruth {
    Image plain, antialiased;
    PreviewTruth(const Scene& scene, const Camera& camera) {
        raster::ForwardOutput output;
        for (const bool compensated : {false, true}) {
            raster::make_plain_rasterizer()->forward(scene.gaussians.spans(), camera,
                                                     image_settings({3, compensated, 1}), output);
            (compensated ? antialiased : plain) = output.colour;
        }
    }
};

class PreviewSweep {
public:
    PreviewSweep(const PreviewSweepParameters& parameters, const JobControl& job)
        : parameters_(parameters), job_(job), settings_(preview_settings(parameters)),
          scene_(synth::timing_scene(static_cast<std::size_t>(parameters.splats), parameters.seed)) {
        if (parameters.backend != "both" && parameters.backend != "native" && parameters.backend != "vulkan")
            throw Error(ErrorCode::InvalidArgument, "there is no renderer \"" + parameters.backend + "\"",
                        "use vulkan, native or both");
        int width = 0, height = 0;
        parse_picture_size(parameters.size, width, height);
        cameras_ = synth::timing_cameras(parameters.frames, width, height);
    }

    std::vector<SettingPoint> run() {
        const PreviewTruth truth(scene_, cameras_.front());
        bool native_is_usual = parameters_.backend == "native";
        if (parameters_.backend != "native") {
            VulkanRenderer renderer(scene_);
            device_ = renderer.info().name;
            native_is_usual = renderer.info().is_cpu && parameters_.backend == "both";
            sweep("Vulkan compute", renderer, truth, !native_is_usual);
        }
        if (parameters_.backend != "vulkan") {
            NativeRenderer renderer(scene_);
            sweep("own rasterizer", renderer, truth, native_is_usual);
        }
        return std::move(points_);
    }
    const std::string& device() const { return device_; }

private:
    void sweep(const std::string& name, SweptRenderer& renderer, const PreviewTruth& truth, bool usual) {
        TurnTimer timer;
        for (const auto& setting : settings_) {
            if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            job_.report("drawing previews", static_cast<int>(points_.size()),
                        static_cast<int>(settings_.size() * (parameters_.backend == "both" ? 2 : 1)));
            SettingPoint point{name, setting_name(setting), usual && setting.full(), {}, {}};
            point.settings = {{"sh_degree", setting.sh_degree},
                              {"antialiased", setting.antialiased},
                              {"scale", setting.scale}};
            const auto error = rms_error(renderer.light(scaled(cameras_.front(), setting), setting),
                                         setting.antialiased ? truth.antialiased : truth.plain);
            const auto times = timer.time(cameras_.size(), [&](std::size_t view) {
                renderer.draw(scaled(cameras_[view], setting), setting);
            });
            point.figures = {{"ms", times.front()},
                             {"median_ms", times[times.size() / 2]},
                             {"rms_error", error},
                             {"psnr_db", error > 0 ? Json(-20 * std::log10(error)) : Json(nullptr)}};
            points_.push_back(std::move(point));
        }
    }

    static Camera scaled(const Camera& camera, const PreviewSetting& setting) {
        const auto side = [&](int full) {
            return std::max(1, static_cast<int>(std::lround(full * setting.scale)));
        };
        Camera small = camera.resized(side(camera.width), side(camera.height));
        // Rounding of the height must not bend the picture.
        small.fy = camera.fy * small.height / camera.height;
        return small;
    }

    PreviewSweepParameters parameters_;
    JobControl job_;
    std::vector<PreviewSetting> settings_;
    Scene scene_;
    std::vector<Camera> cameras_;
    std::vector<SettingPoint> points_;
    std::string device_;
};

}  // namespace

Subject bench_preview_sweep(const PreviewSweepParameters& parameters, const JobControl& job) {
    PreviewSweep sweep(parameters, job);
    const auto points = sweep.run();
    const std::vector<Facet> facets{{"ms", "rms_error", "ms per picture",
                                     "root mean square error (display value 0 to 1)", true,
                                     ChartScale::Logarithmic, ""}};
    Subject subject{"preview", "Preview: error against time, by renderer and quality", {}, {}, {}, {}};
    subject.report = {{"parameters", fields_to_json(parameters)},
                      {"device", sweep.device()},
                      {"points", points_json(points)}};
    subject.report["fronts"] = fronts_of(points, facets);
    Chart chart;
    chart.title = subject.title;
    chart.mark = "default of a still picture here";
    chart.plot_height = 520;
    chart.panels = {panel_of(points, facets.front())};
    chart.panels.front().guides = {
        {preview::MovingScale::FrameMs,
         fmt::format("{:g} ms: limit while the camera moves", preview::MovingScale::FrameMs)}};
    chart.notes = {
        fmt::format("{} splats, {} pixels, wall time, least of {} pictures. Error: to the double-precision "
                    "picture of SH degree 3 at "
                    "full size, of the first of them; \"size\" is drawn smaller and enlarged, "
                    "\"antialiased\" (opacity "
                    "compensation, for scenes made with it) is compared with the truth that has it.{}",
                    number_text(parameters.splats), parameters.size, parameters.frames,
                    sweep.device().empty() ? "" : " Vulkan device: " + sweep.device() + "."),
        "While the camera moves, the window draws the largest size that stays within the limit."};
    subject.picture = draw_chart(chart);
    subject.tables = {points_table(
        "", subject.report["points"],
        {{"ms", "ms"}, {"median_ms", "median ms"}, {"rms_error", "rms error"}, {"psnr_db", "dB"}})};
    subject.remarks = front_remarks(subject.report["fronts"], {"A still picture"});
    return subject;
}

}  // namespace gse::bench
