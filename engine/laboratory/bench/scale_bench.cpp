// Series over one size each, cut off where a point would take too long or too much.
#include "engine/laboratory/bench/scale_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/process_memory.h"
#include "engine/base/thread_pool.h"
#include "engine/laboratory/bench/charts/growth.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/laboratory/synth/timing_scene.h"
#include "engine/raster/rasterizer.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Costs of a size: figures by name, in order.
using Costs = std::vector<std::pair<std::string, double>>;

/// A size that grows, with the sizes and what each costs.
struct GrowthSeries {
    std::string of, title, unit;
    std::vector<std::pair<double, Costs>> points;
    std::vector<double> left_out;
};

/// A scene with a rasterizer of its own and a picture of some size.
class ScaleScene {
public:
    ScaleScene(const Scene& scene, int side)
        : scene_(scene), rasterizer_(raster::make_fast_rasterizer(pool_)),
          camera_(synth::timing_cameras(1, side, side).front()), slope_(side, side, 3, 1.0f) {}
    void forward() { rasterizer_->forward(scene_.gaussians.spans(), camera_, {}, picture_); }
    void backward(std::size_t first_row) { rasterizer_->backward(slope_, {}, first_row, gradients_); }

private:
    const Scene& scene_;
    ThreadPool pool_{0};
    std::unique_ptr<raster::Rasterizer> rasterizer_;
    Camera camera_;
    Image slope_;
    raster::ForwardOutput picture_;
    raster::Gradients gradients_;
};

class ScaleBench {
public:
    ScaleBench(const ScaleBenchParameters& parameters, const pipeline::EditRecipe& settings,
               const JobControl& job)
        : parameters_(parameters), settings_(settings), job_(job), base_mb_(current_rss_mb()) {
        sizes_["splats"] = numbers_in_list("splats", parameters.splats, 1, 2e7);
        sizes_["side"] = numbers_in_list("sizes", parameters.sizes, 16, 8192);
        sizes_["views"] = numbers_in_list("views", parameters.views, 3, 512);
        sizes_["share"] = numbers_in_list("shares", parameters.shares, 1e-6, 1);
    }

    std::vector<GrowthSeries> run() {
        std::vector<GrowthSeries> list;
        list.push_back(series("splats", "splats", "By number of splats", 1, [this](double count) {
            return raster_costs(synth::timing_scene(static_cast<std::size_t>(count), parameters_.seed),
                                parameters_.usual_size);
        }));
        const Scene scene =
            synth::timing_scene(static_cast<std::size_t>(parameters_.usual_splats), parameters_.seed);
        list.push_back(series("side", "pixels a side", "By size of the picture", 2,
                              [&](double side) { return raster_costs(scene, static_cast<int>(side)); }));
        list.push_back(series("share", "labelled share", "By labelled share", 1,
                              [&](double share) { return label_costs(scene, share); }));
        list.push_back(series("views", "views", "By number of views", 1, [&](double views) {
            return back_projection_costs(scene, static_cast<int>(views));
        }));
        if (parameters_.search) add_search(list.back());
        return list;
    }

private:
    void check_stop() const {
        if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
    }

    /// Least wall seconds of the repetitions, after one run to warm up.
    double least_seconds(const std::function<void()>& work) const {
        work();
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < parameters_.repetitions; ++i) {
            check_stop();
            const double start = wall_seconds();
            work();
            least = std::min(least, wall_seconds() - start);
        }
        return least;
    }

    /// Goes on while the next size, grown with that power, keeps the limits. The first one always runs.
    GrowthSeries series(const std::string& of, const std::string& unit, const std::string& title,
                        double power, const std::function<Costs(double)>& measure) {
        GrowthSeries result{of, title, unit, {}, {}};
        const auto& sizes = sizes_[of];
        double took = 0, memory = 0;
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            check_stop();
            job_.report("growing " + of, static_cast<int>(i), static_cast<int>(sizes.size()));
            const double growth = i > 0 ? std::pow(sizes[i] / sizes[i - 1], power) : 0;
            if (took * growth > parameters_.limit_seconds || memory * growth > parameters_.limit_mb) {
                result.left_out.assign(sizes.begin() + static_cast<std::ptrdiff_t>(i), sizes.end());
                break;
            }
            const double start = wall_seconds();
            result.points.emplace_back(sizes[i], measure(sizes[i]));
            took = wall_seconds() - start;
            for (const auto& [name, cost] : result.points.back().second)
                if (name == "memory") memory = cost;
        }
        return result;
    }

    Costs raster_costs(const Scene& scene, int side) const {
        const PeakMemory peak;
        ScaleScene drawn(scene, side);
        const double forward = least_seconds([&] { drawn.forward(); });
        const double backward = least_seconds([&] { drawn.backward(0); });
        return {{"forward", 1e3 * forward},
                {"backward", 1e3 * backward},
                {"memory", std::max(0.0, peak.mb() - base_mb_)}};
    }

    Costs label_costs(const Scene& scene, double share) const {
        ScaleScene drawn(scene, parameters_.usual_size);
        drawn.forward();
        const auto count = scene.gaussians.size();
        const auto labelled = std::clamp<std::size_t>(
            static_cast<std::size_t>(share * static_cast<double>(count) + 0.5), 1, count);
        return {{"backward", 1e3 * least_seconds([&] { drawn.backward(count - labelled); })}};
    }

    /// Half a picture is the mask of every view.
    Costs back_projection_costs(const Scene& scene, int views) const {
        const int side = settings_.request.image_size;
        ThreadPool pool(0);
        const auto rasterizer = raster::make_fast_rasterizer(pool);
        Image mask(side, side, 1);
        std::fill_n(mask.data.begin(), mask.data.size() / 2, 1.0f);
        std::vector<double> masked(scene.gaussians.size()), total(scene.gaussians.size());
        const auto cameras = synth::timing_cameras(views, side, side);
        return {{"back-projection", 1e3 * least_seconds([&] {
                                        for (const auto& camera : cameras)
                                            rasterizer->contributions(scene.gaussians.spans(), camera, {},
                                                                      mask, masked, total);
                                    })}};
    }

    /// Adds the search of one synthetic scene to the views; a point that comes too dear ends it.
    void add_search(GrowthSeries& series) {
        const auto model = pipeline::load_recipe_model(settings_.job);
        pipeline::use_threads(settings_.job);
        synth::SceneSpec spec;
        spec.seed = parameters_.seed;
        const auto scene = synth::generate(spec);
        double took = 0, before = 0;
        for (auto& [views, costs] : series.points) {
            check_stop();
            job_.report("searching", static_cast<int>(views), 0);
            if (before > 0 && took * views / before > parameters_.limit_seconds) break;
            auto recipe = settings_;
            recipe.request.views = static_cast<int>(views);
            recipe.request.least_confidence = 0;
            recipe.request.source = spec.object;
            recipe.request.prompt = fmt::format("a blue {} on the {}", spec.object, spec.ground);
            pipeline::EditJob search(recipe, {scene.scene, {}, model}, {{}, job_.stop});
            const double start = processor_seconds();
            search.locate();
            took = processor_seconds() - start;
            before = views;
            costs.emplace_back("search", 1e3 * took);
            costs.emplace_back("UNet passes", static_cast<double>(search.times().networks().unet));
        }
    }

    ScaleBenchParameters parameters_;
    pipeline::EditRecipe settings_;
    JobControl job_;
    double base_mb_;
    std::map<std::string, std::vector<double>> sizes_;
};

/// Names of what was measured, in the order in which they come.
std::vector<std::string> cost_names(const GrowthSeries& series) {
    std::vector<std::string> names;
    for (const auto& [size, costs] : series.points)
        for (const auto& [name, cost] : costs)
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
}

std::vector<std::array<double, 2>> pairs_of(const GrowthSeries& series, const std::string& what) {
    std::vector<std::array<double, 2>> pairs;
    for (const auto& [size, costs] : series.points)
        for (const auto& [name, cost] : costs)
            if (name == what) pairs.push_back({size, cost});
    return pairs;
}

Json exponent_json(const std::vector<std::array<double, 2>>& pairs) {
    const auto exponent = growth_exponent(pairs);
    return exponent ? Json(*exponent) : Json(nullptr);
}

std::string unit_of(const std::string& cost) {
    return cost == "memory" ? "MiB" : cost == "UNet passes" ? "passes" : "ms";
}

Json series_json(const GrowthSeries& series) {
    Json json{{"of", series.of}, {"left_out", series.left_out}, {"costs", Json::array()}};
    for (const auto& name : cost_names(series)) {
        const auto pairs = pairs_of(series, name);
        const auto upper =
            std::vector(pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2), pairs.end());
        json["costs"].push_back({{"what", name},
                                 {"unit", unit_of(name)},
                                 {"points", pairs},
                                 {"exponent", exponent_json(pairs)},
                                 {"upper_exponent", exponent_json(upper)}});
    }
    return json;
}

/// A panel of the costs in one unit; nothing to draw makes none.
void add_panel(Chart& chart, const Json& series, const std::string& title, const std::string& x_title,
               const std::string& unit) {
    ChartPanel panel{x_title, unit, {}, ChartLine::AllPoints, ChartScale::Logarithmic, true, title, {}};
    for (const auto& cost : series["costs"]) {
        if (cost["unit"] != unit) continue;
        std::string name = cost["what"].get<std::string>();
        if (cost["exponent"].is_number())
            name += fmt::format(": power {:.2f}", cost["exponent"].get<double>());
        if (cost["upper_exponent"].is_number())
            name += fmt::format(", upper half {:.2f}", cost["upper_exponent"].get<double>());
        ChartCurve curve{name, curve_colour(unit == "ms" ? panel.curves.size() : 3), {}};
        for (const auto& pair : cost["points"])
            curve.points.push_back({pair[0].get<double>(), pair[1].get<double>(), "", false});
        panel.curves.push_back(std::move(curve));
    }
    if (!panel.curves.empty()) chart.panels.push_back(std::move(panel));
}

Table growth_table(const GrowthSeries& series) {
    const auto names = cost_names(series);
    Table table{series.title, {series.unit}, {}};
    for (const auto& name : names) table.head.push_back(name + ", " + unit_of(name));
    const auto row_of = [&](const std::string& first, const auto& cell) {
        std::vector<std::string> row{first};
        for (const auto& name : names) row.push_back(cell(name));
        table.rows.push_back(std::move(row));
    };
    for (const auto& [size, costs] : series.points)
        row_of(number_text(size), [&, &all = costs](const std::string& name) {
            for (const auto& [own, cost] : all)
                if (own == name) return number_text(cost);
            return std::string("-");
        });
    row_of("growth exponent", [&](const std::string& name) {
        const auto exponent = growth_exponent(pairs_of(series, name));
        return exponent ? fmt::format("{:.2f}", *exponent) : std::string("-");
    });
    return table;
}

Chart scale_chart(const ScaleBenchParameters& parameters, const Json& report) {
    Chart chart;
    chart.title = "Growth of time and memory";
    chart.plot_height = 250;
    const auto& list = report["series"];
    add_panel(chart, list[0], "Time by number of splats", "splats", "ms");
    add_panel(chart, list[0], "Memory by number of splats", "splats", "MiB");
    add_panel(chart, list[1], "Time by size of the picture", "pixels a side", "ms");
    add_panel(chart, list[1], "Memory by size of the picture", "pixels a side", "MiB");
    add_panel(chart, list[3], "Time by number of views", "views", "ms");
    add_panel(chart, list[2], "Backward pass by labelled share", "labelled share of the splats", "ms");
    chart.notes = {
        fmt::format("Where something else grows: {} splats, SH degree 3, {} x {} pixels. Wall time, least of "
                    "{} timed runs (a search: "
                    "processor time of one run, of a scene of some thousand splats). Memory: most that the "
                    "process held, above what it held "
                    "before. "
                    "Power p: cost grows as size to the p, by least squares over all points; \"upper half\": "
                    "over the larger sizes.",
                    number_text(parameters.usual_splats), parameters.usual_size, parameters.usual_size,
                    parameters.repetitions)};
    return chart;
}

}  // namespace

Subject bench_scale(const ScaleBenchParameters& parameters, const pipeline::EditRecipe& settings,
                    const JobControl& job) {
    const auto list = ScaleBench(parameters, settings, job).run();
    Subject subject{"scale", "Scale: growth of time and memory", {}, {}, {}, {}};
    subject.report = {{"parameters", fields_to_json(parameters)}, {"series", Json::array()}};
    for (const auto& series : list) {
        subject.report["series"].push_back(series_json(series));
        subject.tables.push_back(growth_table(series));
        std::string missing;
        for (const double size : series.left_out) missing += fmt::format(" {}", number_text(size));
        if (!missing.empty())
            subject.remarks.push_back(
                fmt::format("Left out for the limits of time and memory, {}:{}.", series.unit, missing));
    }
    subject.picture = draw_chart(scale_chart(parameters, subject.report));
    return subject;
}

}  // namespace gse::bench
