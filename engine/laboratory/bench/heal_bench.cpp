// Scans without what no view shows, healed, rendered beside the truth.
#include "engine/laboratory/bench/heal_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/thread_pool.h"
#include "engine/evaluate/metrics.h"
#include "engine/io/project/load_scene.h"
#include "engine/laboratory/eval/hole_figures.h"
#include "engine/laboratory/synth/removal_scene.h"
#include "engine/math/noise.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int CaptureSide = 160;
constexpr double LowElevation = 0.25, HighElevation = 0.8, TestElevation = 0.5;
constexpr double LeastSeen = 0.1;  // of what a row shows without the thing, that a scan needs to hold it
constexpr double HoleDifference = 4.0 / 255;

/// Figures of a picture in the hole and outside, with their sums over views.
struct Figures {
    double psnr_delete = 0, psnr_mean = 0, psnr_heal = 0;
    double ssim_delete = 0, ssim_mean = 0, ssim_heal = 0;
    double seam = 0, outside = 0, hole_share = 0;
    double seconds = 0, carried = 0, shadow = 0, added = 0, changed_rows = 0, left = 0;
    int scenes = 0, views = 0;
};

Mask grown(const Mask& mask, int reach) {
    Mask result = mask;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            for (int dy = -reach; dy <= reach; ++dy)
                for (int dx = -reach; dx <= reach; ++dx)
                    if (x + dx >= 0 && y + dy >= 0 && x + dx < mask.width && y + dy < mask.height)
                        result.at(x + dx, y + dy) = 1;
        }
    return result;
}

/// Sum of the gradient's length over the pixels at the rim of a mask.
double rim_gradient(const Image& image, const Mask& mask) {
    double sum = 0;
    for (int y = 0; y + 1 < mask.height; ++y)
        for (int x = 0; x + 1 < mask.width; ++x) {
            const auto cross = [&](int nx, int ny) {
                if (mask.at(x, y) == mask.at(nx, ny)) return;
                for (int c = 0; c < 3; ++c) sum += std::abs(image.at(x, y, c) - image.at(nx, ny, c));
            };
            cross(x + 1, y);
            cross(x, y + 1);
        }
    return sum;
}

Vec3 vector_of(const std::string& name, const std::string& text) {
    std::istringstream words(text);
    Vec3 v;
    if (!(words >> v.x >> v.y >> v.z))
        throw Error(ErrorCode::InvalidArgument, "the setting " + name + " is not three numbers",
                    "write them with spaces between");
    return v;
}

class HealBench {
public:
    HealBench(const HealBenchParameters& parameters, const heal::HealSettings& settings,
              const JobControl& job)
        : parameters_(parameters), settings_(settings), job_(job),
          rasterizer_(raster::make_fast_rasterizer(pool_)) {}

    Subject run() {
        auto names =
            parameters_.kinds == "all" ? synth::removal_scene_names() : words_in_list(parameters_.kinds);
        GaussianSet scan;
        if (!parameters_.scan.empty())
            names = {"scan"}, scan = drawable(load_scene(parameters_.scan).gaussians);
        std::map<std::string, Figures> figures;
        for (const auto& name : names)
            for (int i = 0; i < parameters_.seeds; ++i) {
                if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
                const std::uint64_t seed = parameters_.seed + static_cast<std::uint64_t>(i);
                measure(scan.empty() ? synth::removal_scene(name, seed, parameters_.splats)
                                     : synth::removal_scene_on(scan, vector_of("up", parameters_.up),
                                                               vector_of("place", parameters_.place),
                                                               parameters_.thing_size, seed),
                        figures[name], i == 0);
            }
        return subject(names, figures);
    }

private:
    Image render(const GaussianSet& set, const Camera& camera) {
        rasterizer_->forward(set.spans(), camera, {}, output_);
        return output_.colour;
    }

    /// The scene as a scan holds it: rows that no view shows are missing.
    GaussianSet scanned(const synth::RemovalScene& scene, std::vector<std::uint8_t>& thing) {
        const std::size_t count = scene.scene.size();
        std::vector<double> masked(count, 0), total(count, 0), free_masked(count, 0), free_total(count, 0);
        const Image all(CaptureSide, CaptureSide, 1, 1.0f);
        for (int i = 0; i < parameters_.capture_views; ++i) {
            const double share = (i / 2 + 0.5) / ((parameters_.capture_views + 1) / 2);
            const auto camera =
                scene.camera(share, i % 2 == 0 ? LowElevation : HighElevation, CaptureSide, CaptureSide);
            rasterizer_->contributions(scene.scene.spans(), camera, {}, all, masked, total);
            const std::size_t around = scene.surroundings();
            rasterizer_->contributions(scene.truth.spans(), camera, {}, all,
                                       std::span(free_masked).first(around),
                                       std::span(free_total).first(around));
        }
        std::vector<std::uint8_t> keep(count);
        thing.clear();
        for (std::size_t row = 0; row < count; ++row) {
            keep[row] = scene.thing[row] != 0 || total[row] > LeastSeen * free_total[row] ? 1 : 0;
            if (keep[row] != 0) thing.push_back(scene.thing[row]);
        }
        return scene.scene.filtered(keep);
    }

    /// Takes patches out of the label: where smooth noise is highest on the thing.
    void miss(const GaussianSet& scan, std::vector<std::uint8_t>& thing) const {
        if (!(parameters_.missed > 0)) return;
        constexpr double PatchesPerUnit = 5;
        std::vector<std::pair<double, std::size_t>> values;
        for (std::size_t i = 0; i < thing.size(); ++i) {
            const float* p = &scan.position()[i * 3];
            if (thing[i] != 0) values.emplace_back(value_noise(Vec3{p[0], p[1], p[2]} * PatchesPerUnit), i);
        }
        std::sort(values.begin(), values.end());
        const auto count = static_cast<std::size_t>(parameters_.missed * static_cast<double>(values.size()));
        for (std::size_t k = values.size() - count; k < values.size(); ++k) thing[values[k].second] = 0;
    }

    void measure(const synth::RemovalScene& scene, Figures& figures, bool show) {
        std::vector<std::uint8_t> thing;
        const GaussianSet scan = scanned(scene, thing);
        const auto whole = thing;
        miss(scan, thing);
        const double start = wall_seconds();
        const auto healed = heal::remove_and_heal({scan, thing, scene.up, job_}, settings_);
        figures.seconds += wall_seconds() - start;
        const GaussianSet result = heal::healed_set(scan, healed);
        std::vector<std::uint8_t> keep(thing.size());
        for (std::size_t i = 0; i < thing.size(); ++i) keep[i] = thing[i] == 0 ? 1 : 0;
        const GaussianSet deleted = scan.filtered(keep);
        count_rows(scan, result, healed, figures);
        for (std::size_t i = 0; i < whole.size(); ++i)
            if (whole[i] != 0 && healed.removed[i] == 0) figures.left += 1;
        for (int i = 0; i < parameters_.views; ++i) {
            const auto camera = scene.camera((i + 0.25) / parameters_.views, TestElevation, parameters_.size,
                                             parameters_.size);
            const Image truth = render(scene.truth, camera), plain = render(deleted, camera);
            const Image healthy = render(result, camera);
            compare(truth, plain, healthy, figures);
            if (show && i == parameters_.views / 2)
                strips_.push_back({render(scan, camera), plain, healthy, truth});
        }
        ++figures.scenes;
    }

    static void count_rows(const GaussianSet& scan, const GaussianSet& result, const heal::Healed& healed,
                           Figures& figures) {
        figures.carried += static_cast<double>(healed.carried);
        figures.shadow += static_cast<double>(healed.shadow);
        figures.added += static_cast<double>(healed.added.size());
        std::vector<std::uint8_t> keep(healed.removed.size());
        for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = healed.removed[i] == 0 ? 1 : 0;
        const GaussianSet kept = scan.filtered(keep);
        figures.changed_rows += static_cast<double>(
            evaluate::changed_rows(kept, result, std::vector<std::uint8_t>(kept.size(), 1)));
    }

    static void compare(const Image& truth, const Image& plain, const Image& healthy, Figures& figures) {
        const Mask hole = grown(evaluate::changed_pixels(truth, plain, HoleDifference), 1);
        if (hole.count() == 0) return;
        const evaluate::Region inside{&hole, true};
        const Mask wide = grown(hole, 2);
        const Image mean = mean_filled(plain, hole);
        figures.psnr_delete += evaluate::psnr_db(truth, plain, inside);
        figures.psnr_mean += evaluate::psnr_db(truth, mean, inside);
        figures.psnr_heal += evaluate::psnr_db(truth, healthy, inside);
        figures.ssim_delete += evaluate::ssim(truth, plain, inside);
        figures.ssim_mean += evaluate::ssim(truth, mean, inside);
        figures.ssim_heal += evaluate::ssim(truth, healthy, inside);
        figures.seam += rim_gradient(healthy, hole) / std::max(rim_gradient(truth, hole), 1e-9);
        figures.outside += evaluate::psnr_db(truth, healthy, {&wide, false});
        figures.hole_share += static_cast<double>(hole.count()) / static_cast<double>(hole.data.size());
        ++figures.views;
    }

    Subject subject(const std::vector<std::string>& names, const std::map<std::string, Figures>& figures) {
        Subject subject{"heal", "Removing a thing and healing the hole", {}, picture(), {}, {}};
        subject.report["parameters"] = fields_to_json(parameters_);
        subject.report["settings"] = fields_to_json(settings_);
        Table table{
            "Means over scenes and views",
            {"scene", "PSNR deleted", "PSNR mean colour", "PSNR healed", "SSIM deleted", "SSIM mean colour",
             "SSIM healed", "seam", "PSNR outside", "hole", "s", "added", "lit", "held", "changed", "left"},
            {}};
        for (const auto& name : names) {
            const Figures& f = figures.at(name);
            const double n = std::max(f.views, 1), m = std::max(f.scenes, 1);
            subject.report["kinds"][name] = {{"psnr_delete", f.psnr_delete / n},
                                             {"psnr_mean", f.psnr_mean / n},
                                             {"psnr_heal", f.psnr_heal / n},
                                             {"ssim_delete", f.ssim_delete / n},
                                             {"ssim_mean", f.ssim_mean / n},
                                             {"ssim_heal", f.ssim_heal / n},
                                             {"seam", f.seam / n},
                                             {"psnr_outside", f.outside / n},
                                             {"hole_share", f.hole_share / n},
                                             {"seconds", f.seconds / m},
                                             {"added", f.added / m},
                                             {"lit", f.shadow / m},
                                             {"held", f.carried / m},
                                             {"changed_rows", f.changed_rows / m},
                                             {"left", f.left / m}};
            std::vector<std::string> row{name};
            for (const auto& [key, value] : subject.report["kinds"][name].items())
                row.push_back(fmt::format("{:.3g}", value.get<double>()));
            table.rows.push_back(row);
        }
        subject.tables.push_back(table);
        return subject;
    }

    /// A line per kind: with the thing, deleted, healed, truth.
    Image picture() const {
        const int side = parameters_.size;
        Image sheet(4 * side, static_cast<int>(strips_.size()) * side, 3);
        for (std::size_t k = 0; k < strips_.size(); ++k)
            for (std::size_t i = 0; i < 4; ++i)
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side; ++x)
                        for (int c = 0; c < 3; ++c)
                            sheet.at(static_cast<int>(i) * side + x, static_cast<int>(k) * side + y, c) =
                                strips_[k][i].at(x, y, c);
        return sheet;
    }

    const HealBenchParameters& parameters_;
    const heal::HealSettings& settings_;
    const JobControl& job_;
    ThreadPool pool_{2};
    std::unique_ptr<raster::Rasterizer> rasterizer_;
    raster::ForwardOutput output_;
    std::vector<std::array<Image, 4>> strips_;
};

}  // namespace

Subject bench_heal(const HealBenchParameters& parameters, const heal::HealSettings& settings,
                   const JobControl& job) {
    check_fields(parameters);
    return HealBench(parameters, settings, job).run();
}

}  // namespace gse::bench
