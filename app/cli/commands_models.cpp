// gseditpro models: files of weights on this machine, and which of them can be used.
#include <memory>

#include "app/cli/cli.h"
#include "engine/base/print.h"
#include "engine/pipeline/inventory/inventory_report.h"

namespace gse::app {
namespace {

struct ModelsOptions {
    std::vector<std::filesystem::path> folders;
    bool json = false;
};

void list(const ModelsOptions& options, const CommandContext& context) {
    const auto inventory = pipeline::list_models(options.folders, context.job());
    if (options.json) print_json(pipeline::inventory_json(inventory));
    else fmt::print("{}", pipeline::inventory_text(inventory));
}

}  // namespace

void add_models_command(CLI::App& app, CommandContext& context) {
    auto options = std::make_shared<ModelsOptions>();
    auto* command =
        app.add_subcommand("models", "List the models on this machine: kind of each, and the way to use it");
    command->add_option("folder", options->folders,
                        "Folders or files to look at instead of the usual places of ComfyUI, A1111, Forge, "
                        "SD.Next and krita-ai-diffusion");
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &context] { list(*options, context); });
}

}  // namespace gse::app
