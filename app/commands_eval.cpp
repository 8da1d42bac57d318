// gseditpro eval: edits with ground truth and real scenes, measured.
#include <fmt/format.h>

#include <memory>

#include "app/cli.h"
#include "app/dreambooth_options.h"
#include "app/edit_output.h"
#include "app/eval_run.h"
#include "app/eval_summary.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

namespace gse::app {
namespace {

struct EvalOptions {
    EvalRun run;
    std::filesystem::path output = "out/eval";
    bool json = false;
};

/// The suite's own words, mode and seed are not asked for.
bool is_asked_for(const std::string& field) {
    return field != "source" && field != "prompt" && field != "target" && field != "mode" && field != "seed";
}

void add_settings(CLI::App& command, EditRecipe& settings) {
    command.add_option("--model", settings.job.model, "Model to measure; the starter when left out");
    command.add_option("--device", settings.job.device, "Where the networks run: cpu or cuda")
        ->capture_default_str();
    command
        .add_option("--threads", settings.job.threads,
                    "Threads of the networks; another number may round differently")
        ->capture_default_str()
        ->check(CLI::Range(1, 256));
    const auto bind = [&](const std::string& group) {
        return [&command, group](const char* name, auto& value, const char* help, auto... range) {
            if (group == "Edit" && !is_asked_for(name)) return;
            using Value = std::remove_reference_t<decltype(value)>;
            const std::string option = option_name(name);
            CLI::Option* added = nullptr;
            if constexpr (std::is_same_v<Value, bool>)
                added = command.add_flag(option + ",!--no-" + option.substr(2), value, help);
            else
                added = command.add_option(option, value, help)->capture_default_str();
            if constexpr (sizeof...(range) == 1 && std::is_arithmetic_v<Value>)
                (added->check(CLI::Range(static_cast<double>(range.low), static_cast<double>(range.high))),
                 ...);
            added->group(group);
        };
    };
    edit::EditRequest::visit_fields(settings.request, bind("Edit"));
    neural::SdsParameters::visit_fields(settings.guidance, bind("Guidance (score distillation)"));
}

void run_eval_command(EvalOptions& options, const CommandContext& context) {
    StagedFolder folder(options.output);
    const auto report = run_eval(options.run, folder.path(), context.job());
    const auto table = eval_table(report);
    write_file(folder.path() / "eval.json", report.dump(1) + "\n");
    write_file(folder.path() / "eval.txt", table);
    folder.commit();
    if (options.json)
        fmt::print("{}\n", report.dump(1));
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
    // A size at which 24 edits take minutes on two cores.
    auto& request = options->run.settings.request;
    request.views = 12;
    request.image_size = 64;
    request.iterations = 150;
    add_settings(*command, options->run.settings);
    add_dreambooth_options(*command, options->run.settings);   // of real scenes: the suite's are of the model's own world
    command->callback([options, &context] { run_eval_command(*options, context); });
}

}  // namespace gse::app
