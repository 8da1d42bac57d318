// gseditpro-lab eval: edits with ground truth and real scenes, measured.
#include <fmt/format.h>

#include <memory>

#include "app/cli/dreambooth_options.h"
#include "app/laboratory/eval_settings.h"
#include "app/laboratory/laboratory.h"
#include "app/laboratory/server_table.h"
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
    bench::ServerBenchParameters server_bench;
    bool server = false;  // ways to make a server's views agree are measured, and no edits
    std::filesystem::path output = "out/eval";
    bool json = false;
};

constexpr const char* ServerGroup = "Server (--server)";

/// Table of `bench server`. Throws Error (InvalidArgument) for options that do not count in it, and for those
/// of the table without --server.
void check_server_options(const CLI::App& command, bool server) {
    for (const auto* option : command.get_options()) {
        const bool of_server = option->get_group() == ServerGroup;
        if (option->count() == 0 || option->get_name() == "--out") continue;
        if (server && !of_server)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("{} does not count with --server", option->get_name()),
                        "leave it out: --server measures ways to use a stand-in, and no model");
        if (!server && of_server)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("{} counts with --server only", option->get_name()),
                        "add --server, or leave it out");
    }
}

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
    auto* output = command
                       ->add_option("--out", options->output,
                                    "Folder for eval.json, the table and contact sheets; with --server, "
                                    "a file for the figures as JSON")
                       ->capture_default_str();
    command->add_flag("--json", options->json, "Print the figures as JSON instead of the table");
    command->add_option("--scenes", options->run.scenes,
                        "Real scenes to edit: PATH or PATH:source:sentence:target");
    bind_fields(*command, options->run.parameters, "Suite");
    bind_fields(*command, options->real, "Suite of scanned scenes");
    add_eval_settings(*command, options->run.settings);
    add_dreambooth_options(
        *command, options->run.settings);  // of real scenes: the suite's are of the model's own world
    command
        ->add_flag("--server", options->server,
                   "Measure ways to make a server's views agree, as bench server does, in place of edits")
        ->group(ServerGroup);
    bind_fields(*command, options->server_bench, ServerGroup);
    command->callback([options, output, command, &context] {
        check_server_options(*command, options->server);
        if (options->server)
            return write_server_table(options->server_bench,
                                      output->count() > 0 ? options->output : std::filesystem::path(),
                                      context.job());
        apply_eval_model(*command, options->run.settings);
        run_eval_command(*options, context);
    });
}

}  // namespace gse::app
