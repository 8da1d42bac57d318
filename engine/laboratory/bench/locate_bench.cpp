// One search per scene and setting, as an artist's is; where it labels nothing because it is not sure,
// nothing was found.
#include "engine/laboratory/bench/locate_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/eval/eval_figures.h"
#include "engine/language/words.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Facet>& locate_facets() {
    static const std::vector<Facet> facets{
        {"unet", "error", "UNet passes of a search", "1 - IoU of label and truth, weighted by contribution",
         true, ChartScale::Logarithmic, "Against the networks' passes"},
        {"processor_seconds", "error", "processor seconds of a search",
         "1 - IoU of label and truth, weighted by contribution", true, ChartScale::Logarithmic,
         "Against time"}};
    return facets;
}

/// A point of a search: what is changed of request and attention.
SettingPoint search_point(const std::string& curve, const std::string& name, const Json& request,
                          const Json& attention) {
    return {curve, name, false, {{"request", request}, {"attention", attention}}, {}};
}

std::vector<std::string> level_sets(const std::string& text) {
    std::vector<std::string> sets;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ';');) {
        std::string joined;
        for (const auto& word : words_in_list(part)) joined += (joined.empty() ? "" : " ") + word;
        if (!joined.empty()) sets.push_back(joined);
    }
    return sets;
}

std::vector<SettingPoint> search_points(const LocateBenchParameters& parameters,
                                        const pipeline::EditRecipe& settings) {
    std::vector<SettingPoint> points{search_point("as it is set", "as set", Json::object(), Json::object())};
    points.front().standard = true;
    for (const double count : numbers_in_list("views", parameters.views, 3, 512))
        if (const int views = static_cast<int>(count); views != settings.request.views)
            points.push_back(
                search_point("views", fmt::format("{}", views), {{"views", views}}, Json::object()));
    for (const double count : numbers_in_list("repeats", parameters.repeats, 1, 100))
        if (const int repeats = static_cast<int>(count); repeats != settings.request.attention_repeats)
            points.push_back(search_point("passes per view", fmt::format("x{}", repeats),
                                          {{"attention_repeats", repeats}}, Json::object()));
    for (const auto& set : level_sets(parameters.levels)) {
        numbers_in_list("levels", set, 0, 1);
        points.push_back(search_point("noise levels", set, Json::object(), {{"levels", set}}));
    }
    for (const double count : numbers_in_list("img2img", parameters.img2img, 1, 1000)) {
        const int steps = static_cast<int>(count);
        points.push_back(search_point("img2img", fmt::format("{} steps", steps), Json::object(),
                                      {{"method", "img2img"}, {"steps", steps}}));
    }
    if (parameters.parts) {
        points.push_back(search_point("parts", "no second look", {{"retry_passes", 0}}, Json::object()));
        points.push_back(search_point("parts", "no focus", {{"reframe_views", false}}, Json::object()));
        points.push_back(search_point("parts", "refined maps", Json::object(), {{"refinement", 1}}));
    }
    return points;
}

class LocateBench {
public:
    LocateBench(const LocateBenchParameters& parameters, const pipeline::EditRecipe& settings,
                const JobControl& job)
        : job_(job), settings_(settings), points_(search_points(parameters, settings)),
          suite_(make_suite(parameters.seed, parameters.scenes, language::words_of(parameters.kinds))) {
        for (const auto& edit : suite_)
            if (edit.kind == "add")
                throw Error(ErrorCode::InvalidArgument, "what is added is not there to be found",
                            "use recolour material ground replace");
        for (const auto& point : points_) recipe_of(point);  // out of range: said before anything runs
        model_ = pipeline::load_recipe_model(settings.job);
        pipeline::use_threads(settings.job);
    }

    std::vector<SettingPoint> run() {
        std::vector<std::vector<Json>> found(points_.size());
        for (std::size_t i = 0; i < suite_.size(); ++i) {
            const auto scene = synth::generate(suite_[i].source);
            for (std::size_t p = 0; p < points_.size(); ++p) {
                if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
                job_.report("searching", static_cast<int>(i * points_.size() + p),
                            static_cast<int>(suite_.size() * points_.size()));
                found[p].push_back(search(points_[p], suite_[i], scene));
            }
        }
        for (std::size_t p = 0; p < points_.size(); ++p) points_[p].figures = means(found[p]);
        return points_;
    }
    std::string model() const { return model_->name(); }

private:
    pipeline::EditRecipe recipe_of(const SettingPoint& point) const {
        auto recipe = settings_;
        fields_from_json(recipe.request, point.settings["request"]);
        fields_from_json(recipe.attention, point.settings["attention"]);
        return recipe;
    }

    Json search(const SettingPoint& point, const EvalCase& edit, const synth::SynthScene& scene) const {
        auto recipe = recipe_of(point);
        recipe.request.mode = "auto";
        recipe.request.source = edit.word;
        recipe.request.prompt = edit.prompt;
        pipeline::EditJob job(recipe, {scene.scene, {}, model_}, {{}, job_.stop});
        const double start = processor_seconds();
        job.locate();
        const double took = processor_seconds() - start;
        const auto& label = job.located().label.bits;
        const auto& evidence = job.located().found.field.coverage;
        const bool labelled =
            label && label->size() == scene.parts.size() && evidence.size() == scene.parts.size();
        const auto overlap = labelled ? evaluate::row_overlap(*label, rows_of(scene, edit.part), evidence)
                                      : evaluate::Overlap{0, 0, 0, 0};
        const auto use = job.times().networks();
        return {{"iou", overlap.iou},
                {"error", 1 - overlap.iou},
                {"precision", overlap.precision},
                {"recall", overlap.recall},
                {"unet", use.unet},
                {"tflop", use.flop * 1e-12},
                {"processor_seconds", took},
                {"seconds", job.times().seconds("locate")}};
    }

    /// Means over the scenes, the least IoU of all, and the error of each.
    static Json means(const std::vector<Json>& found) {
        Json mean = Json::object();
        double least = 1;
        for (const auto& entry : found) {
            for (const auto& [name, value] : entry.items())
                mean[name] = mean.value(name, 0.0) + value.get<double>() / static_cast<double>(found.size());
            least = std::min(least, entry["iou"].get<double>());
            mean["per_case"]["error"].push_back(entry["error"]);
        }
        mean["least_iou"] = least;
        return mean;
    }

    JobControl job_;
    pipeline::EditRecipe settings_;
    std::vector<SettingPoint> points_;
    std::vector<EvalCase> suite_;
    std::shared_ptr<neural::TextToImage> model_;
};

}  // namespace

Subject bench_locate(const LocateBenchParameters& parameters, const pipeline::EditRecipe& settings,
                     const JobControl& job) {
    LocateBench bench(parameters, settings, job);
    const auto points = bench.run();
    Subject subject{"locate", "Search: overlap with the truth against cost", {}, {}, {}, {}};
    subject.report = {{"model", bench.model()},
                      {"parameters", fields_to_json(parameters)},
                      {"request", fields_to_json(settings.request)},
                      {"attention", fields_to_json(settings.attention)},
                      {"points", points_json(points)}};
    subject.report["fronts"] = fronts_of(points, locate_facets());
    Chart chart;
    chart.title = subject.title;
    chart.mark = "as everything is set by default";
    for (const auto& facet : locate_facets()) chart.panels.push_back(panel_of(points, facet));
    chart.notes = {fmt::format(
        "{} scenes with true labels that training never saw (seed {}; {}), model {}; means over them. Points "
        "change one "
        "setting of the default: {} views, {} pass{} per view; \"noise levels\" are shares of the schedule, "
        "img2img "
        "looks at the steps of an image-to-image run as the paper does.",
        parameters.scenes, parameters.seed, parameters.kinds, bench.model(), settings.request.views,
        settings.request.attention_repeats, settings.request.attention_repeats == 1 ? "" : "es")};
    subject.picture = draw_chart(chart);
    subject.tables = {points_table("", subject.report["points"],
                                   {{"iou", "IoU"},
                                    {"least_iou", "least IoU"},
                                    {"precision", "precision"},
                                    {"recall", "recall"},
                                    {"unet", "UNet passes"},
                                    {"tflop", "TFLOP"},
                                    {"processor_seconds", "processor s"},
                                    {"seconds", "seconds"}})};
    subject.remarks = front_remarks(subject.report["fronts"], {"Against passes", "Against time"});
    return subject;
}

}  // namespace gse::bench
