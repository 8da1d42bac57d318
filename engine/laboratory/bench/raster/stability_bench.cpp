// Scene after scene, histograms, the worst of each cause.
#include "engine/laboratory/bench/raster/stability_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/base/error.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"
#include "engine/laboratory/bench/raster/raster_sweep.h"
#include "engine/laboratory/bench/raster/stability_chart.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> causes_of(const std::string& list) {
    std::vector<std::string> names;
    for (const auto& cause : hostile_causes()) names.push_back(cause.name);
    if (list == "all") return names;
    std::vector<std::string> chosen;
    for (std::size_t at = 0; at <= list.size();) {  // names have spaces in them
        const auto end = std::min(list.find(',', at), list.size());
        const auto first = list.find_first_not_of(' ', at);
        if (first < end) {
            chosen.push_back(list.substr(first, list.find_last_not_of(' ', end - 1) + 1 - first));
            if (std::find(names.begin(), names.end(), chosen.back()) == names.end())
                throw Error(ErrorCode::InvalidArgument, "there is no cause \"" + chosen.back() + "\"",
                            "use all, or some of: " + fmt::format("{}", fmt::join(names, ", ")));
        }
        at = end + 1;
    }
    if (chosen.empty())
        throw Error(ErrorCode::InvalidArgument, "no causes are named",
                    "use all, or some of: " + fmt::format("{}", fmt::join(names, ", ")));
    return chosen;
}

/// Figures of one kind of error.
Json spread_json(std::vector<double> errors) {
    std::sort(errors.begin(), errors.end());
    const auto at = [&](double share) {
        return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
    };
    std::vector<std::size_t> counts(ErrorDecades, 0);
    for (const double error : errors) ++counts[error_decade(error)];
    return {{"median", at(0.5)}, {"most_of_100", at(0.99)}, {"worst", errors.back()}, {"decades", counts}};
}

template <class Figure>
Json spread_of(const std::vector<const StabilityRecord*>& records, const Figure& figure) {
    std::vector<double> errors;
    for (const auto* record : records)
        errors.push_back(record->error.finite ? figure(record->error) : INFINITY);
    return spread_json(std::move(errors));
}

template <class Figure>
Json worst_scene(const std::vector<const StabilityRecord*>& records, const Figure& figure) {
    const auto* worst = *std::max_element(records.begin(), records.end(), [&](auto* a, auto* b) {
        return figure(a->error) < figure(b->error);
    });
    return {{"seed", worst->seed}, {"kernels", worst->kernels}, {"tensor", worst->error.tensor}};
}

double of_picture(const Disagreement& error) { return error.picture; }
double of_unclear(const Disagreement& error) { return error.unclear_picture; }
double of_row(const Disagreement& error) { return error.row; }
double of_gradient(const Disagreement& error) { return error.gradient; }

Json cause_json(const std::string& cause, const std::vector<const StabilityRecord*>& records) {
    double clear = 0;
    std::size_t miscounted = 0, not_finite = 0, other_bits = 0;
    for (const auto* record : records) {
        clear += record->clear_share / static_cast<double>(records.size());
        miscounted += record->error.miscounted;
        not_finite += record->error.finite ? 0 : 1;
        other_bits += record->error.same_bits ? 0 : 1;
    }
    return {{"cause", cause},
            {"scenes", records.size()},
            {"clear_pixels", clear},
            {"picture", spread_of(records, of_picture)},
            {"picture_worst_scene", worst_scene(records, of_picture)},
            {"gradient", spread_of(records, of_gradient)},
            {"gradient_worst_scene", worst_scene(records, of_gradient)},
            {"row", spread_of(records, of_row)},
            {"row_worst_scene", worst_scene(records, of_row)},
            {"unclear_picture", spread_of(records, of_unclear)},
            {"miscounted_pixels", miscounted},
            {"not_finite", not_finite},
            {"other_bits", other_bits}};
}

Table causes_table(const Json& causes) {
    Table table{"",
                {"cause", "scenes", "clear pixels", "picture median", "worst", "gradient median", "worst",
                 "of", "seed", "worst row", "unclear worst"},
                {}};
    for (const auto& c : causes)
        table.rows.push_back({c["cause"], number_text(c["scenes"]),
                              fmt::format("{:.1f} %", 100 * c["clear_pixels"].get<double>()),
                              number_text(c["picture"]["median"]), number_text(c["picture"]["worst"]),
                              number_text(c["gradient"]["median"]), number_text(c["gradient"]["worst"]),
                              c["gradient_worst_scene"]["tensor"],
                              std::to_string(c["gradient_worst_scene"]["seed"].get<std::uint64_t>()),
                              number_text(c["row"]["worst"]), number_text(c["unclear_picture"]["worst"])});
    return table;
}

HistogramPanel panel_of_causes(const std::string& title, const Json& causes, const char* kind) {
    HistogramPanel panel{title, {}};
    for (const auto& c : causes) panel.counts.push_back(c[kind]["decades"].get<std::vector<std::size_t>>());
    return panel;
}

/// Sentences: what must not be, and whether it was.
std::vector<std::string> verdicts(const Json& causes) {
    std::size_t scenes = 0, not_finite = 0, other_bits = 0, miscounted = 0;
    for (const auto& c : causes) {
        scenes += c["scenes"].get<std::size_t>(), not_finite += c["not_finite"].get<std::size_t>();
        other_bits += c["other_bits"].get<std::size_t>(),
            miscounted += c["miscounted_pixels"].get<std::size_t>();
    }
    return {
        fmt::format("{} pictures with gradients: {} with a value that is not finite; {} in which three "
                    "threads or the view session gave "
                    "other bits than one thread; {} clear pixels with another number of splats.",
                    scenes, not_finite, other_bits, miscounted)};
}

}  // namespace

std::size_t error_decade(double error) {
    if (!(error < 0.1)) return ErrorDecades - 1;
    const double decade =
        std::floor(std::log10(std::max(error, 1e-300)) + 1e-12) + static_cast<double>(ErrorDecades);
    return decade < 1 ? 0 : static_cast<std::size_t>(decade);
}

std::vector<StabilityRecord> measure_stability(const StabilityParameters& parameters, const JobControl& job) {
    std::vector<std::unique_ptr<KernelStability>> versions;
    for (const auto& name : kernels_in_list(parameters.kernels))
        versions.push_back(std::make_unique<KernelStability>(name));
    const auto causes = causes_of(parameters.causes);
    const int total = parameters.scenes * static_cast<int>(causes.size());
    std::vector<StabilityRecord> records;
    int done = 0;
    for (const auto& cause : causes)
        for (int i = 0; i < parameters.scenes; ++i) {
            if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            job.report("comparing", done++, total);
            const std::uint64_t seed = parameters.seed + static_cast<std::uint64_t>(i);
            const HostileScene scene = hostile_scene(cause, seed);
            const StabilityTruth truth(scene);
            for (const auto& version : versions)
                records.push_back(
                    {cause, version->kernels(), seed, truth.clear_share(), version->measure(truth)});
        }
    return records;
}

Subject bench_stability(const StabilityParameters& parameters, const JobControl& job) {
    const auto records = measure_stability(parameters, job);
    Json causes = Json::array();
    std::vector<std::string> names;
    for (const auto& cause : hostile_causes()) {
        std::vector<const StabilityRecord*> own;
        for (const auto& record : records)
            if (record.cause == cause.name) own.push_back(&record);
        if (own.empty()) continue;
        causes.push_back(cause_json(cause.name, own));
        causes.back()["meaning"] = cause.meaning;
        names.push_back(cause.name);
    }
    Subject subject{"stability", "Rasterizer: error on scenes that are hard on single precision, by cause",
                    {},          {},
                    {},          {}};
    subject.report = {{"parameters", fields_to_json(parameters)}, {"causes", causes}};
    subject.tables = {causes_table(causes)};
    subject.remarks = verdicts(causes);
    subject.picture = draw_histograms(
        subject.title, names,
        {panel_of_causes("largest error of a picture's clear pixels", causes, "picture"),
         panel_of_causes("largest relative error of a gradient's tensors (L2)", causes, "gradient")},
        {fmt::format("Pictures per decade of error, to the plain double version; {} scenes per cause and "
                     "instruction set ({}). "
                     "Clear: no pair so "
                     "near to a cut",
                     parameters.scenes, parameters.kernels),
         "that single precision may decide it otherwise. Colour over max(1, the largest colour), depth over "
         "the largest depth."});
    return subject;
}

}  // namespace gse::bench
