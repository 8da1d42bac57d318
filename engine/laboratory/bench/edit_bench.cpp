// Points of two methods, run by the evaluation as variants of one search.
#include "engine/laboratory/bench/edit_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/image/image_file.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/eval/eval_run.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// One setting of a method.
struct EditPoint {
    std::string method, name;
    Json settings;          // of the request
    bool standard = false;  // what the method does where nobody says otherwise
};

EditPoint pulling(int iterations) {
    return {"sds", fmt::format("{}", iterations), {{"method", "sds"}, {"iterations", iterations}}};
}

EditPoint redrawing(int views, int steps, int rounds) {
    return {"views",
            fmt::format("{}x{}x{}", views, steps, rounds),
            {{"method", "views"},
             {"edited_views", views},
             {"view_steps", steps},
             {"restyle_steps", steps},
             {"rounds", rounds}}};
}

/// One of the settings' own points with another quality.
EditPoint of_quality(const char* quality) {
    return {"views", quality, {{"method", "views"}, {"quality", quality}}};
}

EditPoint stopping_at_rest() { return {"sds", "until at rest", {{"method", "sds"}, {"early_stop", true}}}; }

Error not_understood(const std::string& text, const std::string& form) {
    return Error(ErrorCode::InvalidArgument, "the point \"" + text + "\" is not understood",
                 "write it like " + form);
}

/// The settings' own point of each method and those asked for, each once.
std::vector<EditPoint> points_of(const EditBenchParameters& parameters, const edit::EditRequest& request) {
    std::vector<EditPoint> points{pulling(request.iterations), of_quality(request.quality.c_str())};
    for (auto& point : points) point.standard = true;
    const auto add = [&](EditPoint point) {
        if (std::none_of(points.begin(), points.end(),
                         [&](const auto& other) { return other.settings == point.settings; }))
            points.push_back(std::move(point));
    };
    char rest = 0;
    for (const auto& text : words_in_list(parameters.sds)) {
        int iterations = 0;
        if (text == "rest") {
            add(stopping_at_rest());
            continue;
        }
        if (std::sscanf(text.c_str(), "%d%c", &iterations, &rest) != 1 || iterations < 1)
            throw not_understood(text, "100");
        add(pulling(iterations));
    }
    for (const auto& text : words_in_list(parameters.redraws)) {
        int views = 0, steps = 0, rounds = 0;
        if (std::find(std::begin(edit::Qualities), std::end(edit::Qualities), text) !=
            std::end(edit::Qualities)) {
            add(of_quality(text.c_str()));
            continue;
        }
        if (std::sscanf(text.c_str(), "%dx%dx%d%c", &views, &steps, &rounds, &rest) != 3)
            throw not_understood(text, "8x4x1");
        add(redrawing(views, steps, rounds));
    }
    for (const auto& point : points) {  // out of range: said before anything runs
        auto changed = request;
        fields_from_json(changed, point.settings);
    }
    return points;
}

EvalRun run_of(const EditBenchParameters& parameters, const pipeline::EditRecipe& settings,
               const std::vector<EditPoint>& points) {
    EvalRun run;
    run.parameters.seed = parameters.seed;
    run.parameters.edits = run.parameters.ablation_edits = parameters.edits;
    run.parameters.kinds = parameters.kinds;
    run.parameters.mode = parameters.mode;
    run.parameters.held_out_views = parameters.held_out_views;
    run.parameters.oracle_views = parameters.oracle_views;
    run.settings = settings;
    fields_from_json(run.settings.request,
                     points.front().settings);  // the evaluation's own edit is the first point
    for (std::size_t i = 1; i < points.size(); ++i)
        run.variants.push_back(
            {fmt::format("{} {}", points[i].method, points[i].name), "", points[i].settings});
    return run;
}

/// Means over the edits, and what each removed: what was not found or failed has removed nothing.
Json means_of(const Json& edits, std::size_t count) {
    std::map<std::string, double> sums;
    std::map<std::string, std::pair<double, int>> kinds;
    double removed = 0;
    int ran = 0;
    Json each = Json::array();
    for (const auto& edit : edits) {
        const bool failed = edit.contains("error") || !edit.contains("cost");
        const double reduction = failed ? 0 : edit["l1_reduction"].get<double>();
        removed += reduction;
        each.push_back(reduction);
        auto& [sum, of] = kinds[edit["kind"].get<std::string>()];
        sum += reduction;
        ++of;
        if (failed) continue;
        ++ran;
        for (const char* name : {"seconds", "unet", "tflop"}) sums[name] += edit["cost"][name].get<double>();
        for (const char* name : {"leak_rate", "psnr_outside_db"})
            if (edit.contains(name) && edit[name].is_number()) sums[name] += edit[name].get<double>();
    }
    Json means{{"edits", count}, {"ran", ran}};
    means["error_removed"] = count > 0 ? removed / static_cast<double>(count) : 0;
    means["per_case"]["error_removed"] = std::move(each);
    for (const char* name : {"seconds", "unet", "tflop", "leak_rate", "psnr_outside_db"})
        means[name] = ran > 0 ? Json(sums[name] / ran) : Json(nullptr);
    for (const auto& [kind, sum] : kinds)
        means["error_removed_of"][kind] = sum.first / std::max(1, sum.second);
    return means;
}

/// Search that all points share.
Json search_means(const Json& edits) {
    Json means;
    for (const char* name : {"unet", "tflop"}) {
        double sum = 0;
        for (const auto& edit : edits)
            if (edit["networks"].contains("locate")) sum += edit["networks"]["locate"][name].get<double>();
        means[name] = edits.empty() ? 0 : sum / static_cast<double>(edits.size());
    }
    double seconds = 0;
    for (const auto& edit : edits)
        if (edit["seconds"].contains("locate")) seconds += edit["seconds"]["locate"].get<double>();
    means["seconds"] = edits.empty() ? 0 : seconds / static_cast<double>(edits.size());
    return means;
}

Json curves_of(const Json& evaluation, const std::vector<EditPoint>& points) {
    const auto count = evaluation["edits"].size();
    Json curves = Json::array();
    for (const char* method : {"sds", "views"}) {
        Json curve{{"method", method}, {"points", Json::array()}};
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].method != method) continue;
            Json point{
                {"name", points[i].name}, {"settings", points[i].settings}, {"default", points[i].standard}};
            point.update(
                means_of(i == 0 ? evaluation["edits"] : evaluation["ablations"][i - 1]["edits"], count));
            curve["points"].push_back(std::move(point));
        }
        std::stable_sort(curve["points"].begin(), curve["points"].end(), [](const Json& a, const Json& b) {
            return a["tflop"].is_number() && b["tflop"].is_number() &&
                   a["tflop"].get<double>() < b["tflop"].get<double>();
        });
        curves.push_back(std::move(curve));
    }
    return curves;
}

/// Name of a method's curve, as the legend has it.
std::string curve_name(const std::string& method) {
    return method == "sds" ? "sds: iterations" : "views: views x steps x rounds, or quality";
}

/// The curves' points beside each other.
std::vector<SettingPoint> setting_points(const Json& curves) {
    std::vector<SettingPoint> points;
    for (const auto& curve : curves)
        for (const auto& point : curve["points"])
            points.push_back({curve_name(curve["method"].get<std::string>()),
                              point["name"].get<std::string>(), point["default"].get<bool>(),
                              point["settings"], point});
    return points;
}

/// Default that an edit takes by itself.
std::vector<SettingPoint> with_one_default(std::vector<SettingPoint> points) {
    for (auto& point : points) point.standard = point.standard && point.curve == curve_name("views");
    return points;
}

const std::vector<Facet>& edit_facets() {
    static const std::vector<Facet> facets{
        {"tflop", "error_removed", "TFLOP per edit (forward passes of the networks)", "error removed", false,
         ChartScale::Percent, "Against arithmetic"},
        {"seconds", "error_removed", "seconds per edit", "error removed", false, ChartScale::Percent,
         "Against time"}};
    return facets;
}

Chart chart_of(const Json& report) {
    Chart chart;
    const auto& parameters = report["parameters"];
    const auto& search = report["search"];
    chart.title =
        fmt::format("What an edit removes of the error, and what it costs: {} edits, seed {}, model {}",
                    report["edits"].get<std::size_t>(), parameters["seed"].get<std::uint64_t>(),
                    report["model"].get<std::string>());
    chart.mark = "default of a method";
    for (const auto& facet : edit_facets()) {
        chart.panels.push_back(panel_of(setting_points(report["curves"]), facet));
        chart.panels.back().line = ChartLine::OwnFront;
    }
    chart.notes = {
        "Error: mean absolute difference to the true edited scene inside the true part, on views between "
        "those of the edit. "
        "Lines: the front of each method.",
        fmt::format(
            "The search before an edit comes on top: {:.2g} TFLOP, {:.2g} s, {:.0f} UNet passes. Kinds: {}.",
            search["tflop"].get<double>(), search["seconds"].get<double>(), search["unet"].get<double>(),
            parameters["kinds"].get<std::string>())};
    return chart;
}

}  // namespace

Json bench_edit(const EditBenchParameters& parameters, const pipeline::EditRecipe& settings,
                const std::filesystem::path& folder, const JobControl& job) {
    const auto points = points_of(parameters, settings.request);
    Json evaluation = run_eval(run_of(parameters, settings, points), folder, job);
    Json report{{"model", evaluation["model"]},
                {"parameters", fields_to_json(parameters)},
                {"edits", evaluation["edits"].size()}};
    report["stopped"] = evaluation["stopped"];
    report["search"] = search_means(evaluation["edits"]);
    report["curves"] = curves_of(evaluation, points);
    report["fronts"] = fronts_of(with_one_default(setting_points(report["curves"])), edit_facets());
    report["picture"] = "pareto.png";
    write_png(folder / "pareto.png", draw_chart(chart_of(report)));
    report["evaluation"] = std::move(evaluation);
    return report;
}

Subject edit_bench_subject(Json report) {
    Subject subject{"edit", "Edits: error removed against cost, by method", {}, {}, {}, {}};
    const auto points = points_json(setting_points(report["curves"]));
    subject.picture = draw_chart(chart_of(report));
    subject.tables = {points_table("", points,
                                   {{"error_removed", "error removed"},
                                    {"tflop", "TFLOP"},
                                    {"unet", "UNet passes"},
                                    {"seconds", "seconds"},
                                    {"leak_rate", "leak"},
                                    {"psnr_outside_db", "dB outside"}})};
    const auto& search = report["search"];
    subject.remarks = front_remarks(report["fronts"], {"Against arithmetic", "Against time"});
    subject.remarks.push_back(
        fmt::format("The search before each edit: {} TFLOP, {} UNet passes, {} seconds.",
                    number_text(search["tflop"].get<double>()), number_text(search["unet"].get<double>()),
                    number_text(search["seconds"].get<double>())));
    report.erase("evaluation");
    subject.report = std::move(report);
    return subject;
}

}  // namespace gse::bench
