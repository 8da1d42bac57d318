// One list of the report's parts for both ways.
#include "engine/pipeline/models/tuning_json.h"

#include "engine/base/json.h"

namespace gse::pipeline {
namespace {

template <class Report, class F> void visit_report(Report& report, F&& f) {
    f("steps", report.steps);
    f("skipped", report.skipped);
    f("class_seconds", report.class_seconds);
    f("seconds", report.seconds);
    f("instance_before", report.instance_before);
    f("instance_after", report.instance_after);
    f("prior_before", report.prior_before);
    f("prior_after", report.prior_after);
    f("instance_losses", report.instance_losses);
    f("prior_losses", report.prior_losses);
}

}  // namespace

nlohmann::ordered_json tuning_to_json(const neural::TuneReport& report) {
    nlohmann::ordered_json json;
    visit_report(report, [&](const char* name, const auto& value) { json[name] = value; });
    return json;
}

std::optional<neural::TuneReport> tuning_from_json(std::string_view text) {
    const auto json = try_parse_json(text);
    neural::TuneReport report;
    try {
        visit_report(report, [&](const char* name, auto& value) { json.at(name).get_to(value); });
    } catch (const nlohmann::json::exception&) { return std::nullopt; }
    return report;
}

}  // namespace gse::pipeline
