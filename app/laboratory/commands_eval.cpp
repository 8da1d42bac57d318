// gseditpro-lab eval: edits with ground truth and real scenes, measured.
#include <fmt/format.h>

#include <memory>

#include "app/cli/dreambooth_options.h"
#include "app/laboratory/eval_settings.h"
#include "app/laboratory/laboratory.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/path_text.h"
#include "engine/base/staged_folder.h"
#include "engine/laboratory/eval/eval_run.h"
#include "engine/laboratory/eval/eval_summary.h"
#include "engine/laboratory/eval/real/real_eval.h"
#include "engine/laboratory/eval/real/real_summary.h"
#include "engine/pipeline/report/edit_output.h"

namespace gse::app {
namespace {

struct EvalOptions {
    EvalRun run;
    RealParameters real;
    std::filesystem::path output = "out/eval";
    bool json = false;
};

void run_eval_command(EvalOptions& options, const CommandContext& context) {
    StagedFolder folder(options.output, {"eval.json", {"eval.json", "eval.txt"}});
    folder.keep_on_failure();  // from the first sheet on
    const bool real = !options.real.real.empty();
    auto report = real ? run_real({options.real, options.run.settings}, folder.path(), context.job())
                       : run_eval(options.run, folder.path(), context.job());
    const auto table = real ? real_table(report) : eval_table(report);
    write_file(folder.path() / "eval.txt", table);
    report["files"] = folder.listing();
    write_file(folder.path() / "eval.json", json_text(report, 1) + "\n");
    folder.commit();
    if (options.json) fmt::print("{}\n", json_text(report, 1));
    else
        fmt::print("{}\nfigures {}/eval.json\n", table,
                   std::filesystem::absolute(options.output).lexically_normal().string());
    if (report["stopped"].get<bool>())
        throw Error(ErrorCode::Cancelled, "the evaluation was stopped; what it had reached is saved", "",
                    options.output);
}

}  // namespace

void add_eval_command(CLI::App& app, CommandContext& context) {
    auto options = std::make_shared<EvalOptions>();
    auto* command =
        app.add_subcommand("eval", "Measure a model on edits whose true result is known, and on real scenes");
    command->add_option("--out", options->output, "Folder for eval.json, the table and contact sheets")
        ->capture_default_str();
    command->add_flag("--json", options->json, "Print the figures as JSON instead of the table");
    command->add_option("--scenes", options->run.scenes,
                        "Real scenes to edit: PATH or PATH:source:sentence:target");
    bind_fields(*command, options->run.parameters, "Suite");
    bind_fields(*command, options->real, "Suite of scanned scenes");
    add_eval_settings(*command, options->run.settings);
    add_dreambooth_options(
        *command, options->run.settings);  // of real scenes: the suite's are of the model's own world
    command->callback([options, command, &context] {
        apply_eval_model(*command, options->run.settings);
        run_eval_command(*options, context);
    });
}

}  // namespace gse::app
