// Generated scenes through the rasterizer's bench, with the floor.
#include "engine/laboratory/bench/raster/floor_cases.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/laboratory/bench/raster/raster_report.h"
#include "engine/laboratory/synth/timing_scene.h"
#include "engine/raster/bench.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string milliseconds(const Json& value) { return fmt::format("{:.1f}", value.get<double>()); }

}  // namespace

std::vector<FloorCase> floor_cases_in_list(const std::string& text) {
    std::vector<FloorCase> cases;
    for (const auto& word : words_in_list(text)) {
        const auto at = word.find('@');
        if (at == std::string::npos)
            throw Error(ErrorCode::InvalidArgument, "\"" + word + "\" is no case",
                        "write splats@WIDTHxHEIGHT, as in 100000@512x512");
        constexpr double most_splats = 2e7;
        FloorCase found;
        found.splats = static_cast<std::size_t>(
            numbers_in_list("floor_cases", word.substr(0, at), 1, most_splats).at(0));
        parse_picture_size(word.substr(at + 1), found.width, found.height);
        cases.push_back(found);
    }
    return cases;
}

Json bench_floor_cases(const std::vector<FloorCase>& cases, std::uint64_t seed, int views, int repetitions,
                       const JobControl& job) {
    Json reports = Json::array();
    for (const auto& one : cases) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
        job.report("comparing with the floor", static_cast<int>(reports.size()),
                   static_cast<int>(cases.size()));
        const Scene scene = synth::timing_scene(one.splats, seed);
        raster::BenchSettings settings;
        settings.width = one.width, settings.height = one.height;
        settings.repetitions = repetitions;
        settings.compare_plain = false;
        settings.floor = true;
        const auto cameras = synth::timing_cameras(views, one.width, one.height);
        Json report{{"splats", one.splats}, {"picture", fmt::format("{}x{}", one.width, one.height)}};
        report.update(floor_report(raster::bench_raster(scene.gaussians.spans(), cameras, settings)));
        reports.push_back(report);
    }
    return reports;
}

Table floor_table(const Json& cases) {
    Table table{"Forward and backward against the floor of this machine",
                {"case", "ms", "processor ms per thread", "floor ms", "blend", "lists", "parameters", "ratio",
                 "of processor time"},
                {}};
    for (const auto& report : cases) {
        const auto &floor = report["ms"], &ratio = report["ratio"];
        const auto sum = [&](const char* a, const char* b) {
            return fmt::format("{:.1f}", floor[a].get<double>() + floor[b].get<double>());
        };
        table.rows.push_back({fmt::format("{} splats, {}", report["splats"].get<std::size_t>(),
                                          report["picture"].get<std::string>()),
                              milliseconds(report["measured_ms"]["wall"]),
                              milliseconds(report["measured_ms"]["processor_per_thread"]),
                              milliseconds(floor["total"]), sum("forward_blend", "backward_blend"),
                              milliseconds(floor["lists"]), sum("parameters", "parameter_gradients"),
                              fmt::format("{:.2f}", ratio["wall"].get<double>()),
                              fmt::format("{:.2f}", ratio["processor"].get<double>())});
    }
    return table;
}

std::string floor_text(const Json& report) {
    return fmt::format(
        "forward and backward on {} threads {} ms, floor {} ms: {:.2f} times (processor time {:.2f} times)",
        report["threads"].get<unsigned>(), milliseconds(report["measured_ms"]["wall"]),
        milliseconds(report["ms"]["total"]), report["ratio"]["wall"].get<double>(),
        report["ratio"]["processor"].get<double>());
}

}  // namespace gse::bench
