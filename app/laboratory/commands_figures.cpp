// gseditpro-lab figures: writes engine/FIGURES.md.
#include <fmt/format.h>

#include <memory>

#include "app/laboratory/eval_settings.h"
#include "app/laboratory/laboratory.h"
#include "engine/base/file.h"
#include "engine/laboratory/figures/figures.h"

namespace gse::app {

void add_figures_command(CLI::App& app, CommandContext& context) {
    struct Options {
        FiguresRun run;
        std::filesystem::path output;
    };
    auto options = std::make_shared<Options>();
    options->run.results = "out/figures";
    auto* command = app.add_subcommand(
        "figures", "Write the page of measurements, engine/FIGURES.md; hours, unless the results are there");
    command->add_option("--out", options->output, "Page to write; left out, it is printed");
    command
        ->add_option(
            "--results", options->run.results,
            "Folder of results: those that it holds are taken, the others are measured and kept there")
        ->capture_default_str();
    bind_fields(*command, options->run.parameters, "Measurement");
    command->callback([options, command, &context] {
        apply_eval_model(*command, options->run.settings);
        const auto page = figures_page(options->run, context.job());
        if (options->output.empty()) fmt::print("{}", page);
        else write_file(options->output, page);
    });
}

}  // namespace gse::app
