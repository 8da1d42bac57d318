// Suites, their results on the disk, and the page.
#include "engine/laboratory/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/staged_folder.h"
#include "engine/laboratory/bench/charts/machine.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/laboratory/bench/clip_bench.h"
#include "engine/laboratory/bench/edit_bench.h"
#include "engine/laboratory/bench/raster/speed_bench.h"
#include "engine/laboratory/bench/raster/stability_bench.h"
#include "engine/laboratory/bench/search_bench.h"
#include "engine/laboratory/bench/server_bench.h"
#include "engine/laboratory/eval/eval_run.h"
#include "engine/laboratory/eval/real/real_eval.h"
#include "engine/laboratory/figures/figure_tables.h"
#include "engine/laboratory/figures/real_tables.h"
#include "engine/laboratory/figures/reliability_table.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/recipe_model.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::array Suites{"edits",   "words",     "searches", "encoder", "methods",
                            "servers", "stability", "speed",    "real"};

/// An evaluation of the page: its name and how it departs from the standard one.
struct Evaluation {
    const char* name;
    int edits;
    const char* kinds;
    bool drawn_words;
};
constexpr Evaluation Standard{"eval", 30, "recolour material add ground replace", false};
constexpr Evaluation Dyes{"eval_dye", 12, "dye", false};
constexpr Evaluation DrawnWords{"eval_drawn", 12, "replace add", true};

EvalParameters parameters_of(const Evaluation& evaluation, std::uint64_t seed) {
    EvalParameters parameters;
    parameters.seed = seed;
    parameters.edits = evaluation.edits;
    parameters.kinds = evaluation.kinds;
    parameters.drawn_words = evaluation.drawn_words;
    return parameters;
}

std::string command_of(const Evaluation& evaluation) {
    if (evaluation.name == std::string_view(Standard.name)) return "gseditpro-lab eval --seed SEED";
    return fmt::format("gseditpro-lab eval --seed SEED --kinds \"{}\" --edits {}{}", evaluation.kinds,
                       evaluation.edits, evaluation.drawn_words ? " --drawn-words" : "");
}

/// A bench that writes one JSON: the file below the results, and the command that makes the same.
struct Bench {
    const char* file;
    const char* command;
};
constexpr Bench Searches{"search.json", "gseditpro-lab bench search --scenes 8 --seed 62"};
constexpr Bench NoGround{"search_no_ground.json",
                         "gseditpro-lab bench search --scenes 8 --seed 65 --no-ground"};
constexpr Bench Encoder{"clip.json", "gseditpro-lab bench clip"};
constexpr Bench Methods{"methods/edit.json", "gseditpro-lab bench edit"};
constexpr Bench Servers{"server.json", "gseditpro-lab bench server --side 192"};
constexpr Bench Stability{"stability/stability.json", "gseditpro-lab bench stability"};
constexpr Bench Speed{"speed.md", "gseditpro-lab bench speed"};
constexpr Bench Machine{"machine.json", ""};

Json read_json(const fs::path& path) { return parse_json<Json>(read_file(path), path.string()); }

class Page {
public:
    Page(const FiguresRun& run, const JobControl& job) : run_(run), job_(job) {
        for (const double seed : numbers_in_list("seeds", run.parameters.seeds, 0, 1e9))
            seeds_.push_back(static_cast<std::uint64_t>(seed));
        wanted_ = words_in_list(run.parameters.suites);
        for (const auto& suite : wanted_)
            if (std::find(Suites.begin(), Suites.end(), suite) == Suites.end())
                throw Error(ErrorCode::InvalidArgument, "there is no suite \"" + suite + "\"",
                            fmt::format("use some of {}", fmt::join(Suites, " ")));
        fs::create_directories(run.results);
    }

    std::string text() {
        const auto sections = edits() + words() + reliability() + searches() + encoder() + methods() +
                              servers() + stability() + speed() + scans();
        return head() + sections;
    }

private:
    bool wants(const char* suite) const {
        return std::find(wanted_.begin(), wanted_.end(), suite) != wanted_.end();
    }

    fs::path place(const Bench& bench) const { return run_.results / bench.file; }

    std::string head() {
        const auto path = place(Machine);
        if (!fs::exists(path)) write_file(path, machine_json().dump(1) + "\n");
        const Json machine = read_json(path);
        return fmt::format(
            "# Figures\n\nOne command writes this page; do not edit it by hand:\n\n```sh\ngseditpro-lab "
            "figures "
            "--seeds \"{}\" --results FOLDER --real SUITE{} --out engine/FIGURES.md\n```\n\nMeasured on: {}, "
            "{} cores, {}; "
            "the bundled model,\neverything "
            "else as it is set by default. FOLDER's results are taken, others are measured.\nGoals and "
            "words are explained in "
            "[METHOD.md](METHOD.md#metrics).\n",
            run_.parameters.seeds, run_.parameters.verdicts.empty() ? "" : " \\\n    --verdicts FILE",
            machine["processor"].get<std::string>(), machine["cores"].get<int>(),
            machine["instruction_sets"].get<std::string>());
    }

    static std::string section(const std::string& title, const std::string& command, const std::string& table,
                               const std::string& seeds = {}) {
        const auto body = table.empty() ? std::string("Not measured yet.\n") : table;
        return fmt::format("\n## {}\n\n`{}`{}\n\n{}", title, command, seeds, body);
    }

    std::string seeds_text() const { return ", seeds " + run_.parameters.seeds; }

    /// The result of an evaluation, measured where that is wanted and not there; null where there is none.
    Json evaluation(const Evaluation& which, std::uint64_t seed, const char* suite) {
        const auto folder = run_.results / fmt::format("{}_{}", which.name, seed);
        const auto parameters = parameters_of(which, seed);
        if (!fs::exists(folder / "eval.json")) {
            if (!wants(suite)) return nullptr;
            StagedFolder staged(folder, {"eval.json", {"eval.json"}});
            const Json report = run_eval({parameters, run_.settings, {}, {}}, staged.path(), job_);
            if (report["stopped"].get<bool>())
                throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            write_file(staged.path() / "eval.json", json_text(report, 1) + "\n");
            staged.commit();
        }
        Json report = read_json(folder / "eval.json");
        if (report["parameters"] != fields_to_json(parameters))
            throw Error(ErrorCode::Malformed, "the result is of other settings",
                        "remove it, or choose another folder", folder / "eval.json");
        return report;
    }

    std::vector<Json> evaluations(const Evaluation& which, const char* suite) {
        std::vector<Json> reports;
        for (const auto seed : seeds_)
            if (Json report = evaluation(which, seed, suite); !report.is_null())
                reports.push_back(std::move(report));
        return reports;
    }

    /// The text of a bench's result, measured where that is wanted and not there; empty where there is none.
    std::string result(const Bench& bench, const char* suite, const std::function<std::string()>& measure) {
        const auto path = place(bench);
        if (!fs::exists(path)) {
            if (!wants(suite)) return {};
            const auto text = measure();
            fs::create_directories(path.parent_path());
            write_file(path, text);
        }
        return read_file(path);
    }

    template <class Table>
    std::string bench_table(const Bench& bench, const char* suite, const Table& table,
                            const std::function<Json()>& measure) {
        const auto text = result(bench, suite, [&] { return json_text(measure(), 1) + "\n"; });
        return text.empty() ? std::string() : table(parse_json<Json>(text, place(bench).string()));
    }

    std::string edits() {
        const auto reports = evaluations(Standard, "edits");
        const auto command = command_of(Standard);
        const auto all = [&](std::string (*table)(const std::vector<Json>&)) {
            return reports.empty() ? std::string() : table(reports);
        };
        return section("Edits with a known result", command, all(edits_table), seeds_text()) +
               section("Edits by kind", command, all(kinds_table), seeds_text()) +
               section("Passes of the UNet over one picture", command, all(passes_table), seeds_text());
    }

    std::string words() {
        const auto of = [&](const Evaluation& which) {
            const auto reports = evaluations(which, "words");
            return reports.empty() ? std::string() : words_table(reports);
        };
        return section("Colours without a word", command_of(Dyes), of(Dyes), seeds_text()) +
               section("Things that are drawn and not looked for", command_of(DrawnWords), of(DrawnWords),
                       seeds_text());
    }

    std::string reliability() {
        return section("How right a label is, by its confidence", command_of(Standard),
                       reliability_table(evaluations(Standard, "edits"), scans_report()),
                       seeds_text() + ", and `gseditpro-lab eval --real SUITE` by word");
    }

    std::string searches() {
        const auto of = [&](const Bench& bench, std::uint64_t seed, bool ground) {
            SearchBenchParameters parameters;
            parameters.scenes = 8;
            parameters.seed = seed;
            parameters.ground = ground;
            const double least = run_.settings.request.least_confidence;
            return bench_table(
                bench, "searches", [&](const Json& json) { return searches_table(json, least); },
                [&] { return bench_search(parameters, run_.settings, job_); });
        };
        return section("Searches", Searches.command, of(Searches, 62, true)) +
               section("Searches in scenes without a ground", NoGround.command, of(NoGround, 65, false));
    }

    std::string encoder() {
        return section("Encoder and front", Encoder.command,
                       bench_table(Encoder, "encoder", encoder_table, [&] {
                           const auto model = pipeline::load_recipe_model(run_.settings.job);
                           const auto score = model->image_text_encoder();
                           if (!score)
                               throw Error(ErrorCode::NotFound, "the model has no image-text encoder");
                           return bench_clip(*score, {}, job_);
                       }));
    }

    std::string methods() {
        return section("Redrawn views and score distillation", Methods.command,
                       bench_table(Methods, "methods", methods_table, [&] {
                           fs::create_directories(place(Methods).parent_path());
                           return bench_edit({}, run_.settings, place(Methods).parent_path(), job_);
                       }));
    }

    std::string servers() {
        return section("Views of a server that contradicts itself", Servers.command,
                       bench_table(Servers, "servers", servers_table, [&] {
                           ServerBenchParameters parameters;
                           parameters.side = 192;
                           return agreement_json(bench_server(
                               pipeline::assets_path() / "scenes/bear/scene.ply", parameters, job_));
                       }));
    }

    std::string stability() {
        return section("Error of the rasterizer on hard scenes", Stability.command,
                       bench_table(Stability, "stability", stability_table,
                                   [&] { return bench_stability({}, job_).report; }));
    }

    std::string speed() {
        return section("Speed", Speed.command, result(Speed, "speed", [] { return speed_table({}); }));
    }

    /// The evaluation on scans, measured where a suite is named and it is not there; null where there is
    /// none.
    Json scans_report() {
        const auto folder = run_.results / "real";
        if (!fs::exists(folder / "eval.json")) {
            if (!wants("real") || run_.parameters.real.empty()) return nullptr;
            RealParameters parameters;
            parameters.real = run_.parameters.real;
            StagedFolder staged(folder, {"eval.json", {"eval.json"}});
            const Json report = run_real({parameters, run_.settings}, staged.path(), job_);
            if (report["stopped"].get<bool>())
                throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            write_file(staged.path() / "eval.json", json_text(report, 1) + "\n");
            staged.commit();
        }
        Json report = read_json(folder / "eval.json");
        const auto& parameters = report["parameters"];
        if (parameters["real_only"] != "" || parameters["real_modes"] != RealParameters().real_modes)
            throw Error(ErrorCode::Malformed, "the result is of a part of the suite",
                        "remove it, or choose another folder", folder / "eval.json");
        return report;
    }

    Json verdicts() const {
        const auto& file = run_.parameters.verdicts;
        return file.empty() ? Json::object() : read_json(file);
    }

    std::string scans() {
        const Json report = scans_report();
        return section("Scans with truth made by hand", "gseditpro-lab eval --real SUITE",
                       report.is_null() ? std::string() : real_tables(report, verdicts()));
    }

    const FiguresRun& run_;
    const JobControl& job_;
    std::vector<std::uint64_t> seeds_;
    std::vector<std::string> wanted_;
};

}  // namespace

std::string figures_page(const FiguresRun& run, const JobControl& job) { return Page(run, job).text(); }

}  // namespace gse::bench
