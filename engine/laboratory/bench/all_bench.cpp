// One subject after the other.
#include "engine/laboratory/bench/all_bench.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/laboratory/bench/charts/machine.h"
#include "engine/laboratory/bench/charts/page.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"
#include "engine/laboratory/bench/edit_bench.h"
#include "engine/laboratory/bench/locate_bench.h"
#ifdef GSE_WINDOW
#include "engine/laboratory/bench/raster/preview_sweep.h"
#endif
#include "engine/io/image/image_file.h"
#include "engine/laboratory/bench/raster/raster_sweep.h"
#include "engine/laboratory/bench/raster/stability_bench.h"
#include "engine/laboratory/bench/scale_bench.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string>& subject_names() {
    static const std::vector<std::string> names{"raster", "stability", "preview", "locate", "edit", "scale"};
    return names;
}

/// Sentences: where the parameters used are not those that the subject has by itself.
template <class P> std::vector<std::string> departures(const P& used) {
    const Json now = fields_to_json(used), usual = fields_to_json(P{});
    std::string text;
    for (const auto& [name, value] : now.items())
        if (value != usual[name])
            text += fmt::format("{}{} {} instead of {}", text.empty() ? "" : "; ", name, value.dump(),
                                usual[name].dump());
    if (text.empty()) return {};
    return {"Other than by default, for the sake of time: " + text + "."};
}

/// The numbers of the list that are not above `most`.
std::string up_to(const std::string& list, double most) {
    std::string kept;
    for (const double number : numbers_in_list("list", list, 0, 1e12))
        if (number <= most) kept += (kept.empty() ? "" : " ") + fmt::format("{:.0f}", number);
    return kept;
}

class AllBench {
public:
    AllBench(const AllBenchParameters& parameters, const pipeline::EditRecipe& settings,
             std::filesystem::path folder, const JobControl& job)
        : parameters_(parameters), settings_(settings), folder_(std::move(folder)), job_(job) {}

    Json run() {
        const auto names = words_in_list(parameters_.subjects);
        const auto& known = subject_names();
        for (const auto& name : names)
            if (std::find(known.begin(), known.end(), name) == known.end())
                throw Error(ErrorCode::InvalidArgument, "there is no subject \"" + name + "\"",
                            "use some of " + joined(known));
        Json report{{"machine", machine_json()},
                    {"parameters", fields_to_json(parameters_)},
                    {"subjects", Json::object()},
                    {"seconds", Json::object()}};
        for (const auto& name : known) {
            if (std::find(names.begin(), names.end(), name) == names.end()) continue;
            const double start = wall_seconds();
            report["subjects"][name] = measure(name);
            report["seconds"][name] = wall_seconds() - start;
        }
        Json head = report["machine"];
        for (const auto& [name, seconds] : report["seconds"].items()) head["seconds of " + name] = seconds;
        write_file(folder_ / "index.html",
                   html_page("GSEditPro: error, time and memory, measured", head, sections_));
        return report;
    }

private:
    static std::string joined(const std::vector<std::string>& words) {
        std::string text;
        for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
        return text;
    }

    /// A subject's report; of one that failed, why.
    Json measure(const std::string& name) {
        try {
            return name == "raster"      ? raster()
                   : name == "stability" ? stability()
                   : name == "preview"   ? preview()
                   : name == "locate"    ? locate()
                   : name == "edit"      ? edit()
                                         : scale();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled || error.code() == ErrorCode::InvalidArgument) throw;
            sections_.push_back({name, {"This could not be measured: " + error.message()}, {}, {}, {}, {}});
            return {{"error", error.message()}};
        }
    }

    template <class P> Json take(const Subject& subject, const P& used) {
        const auto path = folder_ / (subject.name + ".png");
        write_png(path, subject.picture);
        sections_.push_back({subject.title, departures(used), read_file(path), subject.tables,
                             subject.remarks, fields_to_json(used)});
        return subject.report;
    }

    Json raster() {
        RasterSweepParameters used;
        used.splats = parameters_.raster_splats;
        return take(bench_raster_sweep(used, job_), used);
    }
    Json stability() {
        const StabilityParameters used;
        return take(bench_stability(used, job_), used);
    }
    Json preview() {
#ifdef GSE_WINDOW
        PreviewSweepParameters used;
        used.splats = parameters_.preview_splats;
        used.frames = 8;
        return take(bench_preview_sweep(used, job_), used);
#else
        throw Error(ErrorCode::Unsupported, "this build has no preview");
#endif
    }
    Json locate() {
        LocateBenchParameters used;
        used.seed = parameters_.seed;
        used.scenes = parameters_.locate_scenes;
        return take(bench_locate(used, settings_, job_), used);
    }
    Json edit() {
        EditBenchParameters used;
        used.seed = parameters_.seed;
        used.edits = parameters_.edits;
        const auto sheets = folder_ / "edits";
        std::filesystem::create_directories(sheets);
        auto report = bench_edit(used, settings_, sheets, job_);
        std::filesystem::remove_all(sheets);  // the page has the picture
        return take(edit_bench_subject(std::move(report)), used);
    }
    Json scale() {
        ScaleBenchParameters used;
        used.splats = up_to(used.splats, parameters_.scale_most_splats);
        used.sizes = up_to(used.sizes, parameters_.scale_most_side);
        return take(bench_scale(used, settings_, job_), used);
    }

    AllBenchParameters parameters_;
    pipeline::EditRecipe settings_;
    std::filesystem::path folder_;
    JobControl job_;
    std::vector<PageSection> sections_;
};

}  // namespace

Json bench_all(const AllBenchParameters& parameters, const pipeline::EditRecipe& settings,
               const std::filesystem::path& folder, const JobControl& job) {
    Json report = AllBench(parameters, settings, folder, job).run();
    write_file(folder / "all.json", json_text(report, 1) + "\n");
    return report;
}

std::vector<std::string> all_bench_files() {
    std::vector<std::string> files{"index.html", "all.json"};
    for (const auto& name : subject_names()) files.push_back(name + ".png");
    return files;
}

}  // namespace gse::bench
