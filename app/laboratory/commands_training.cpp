// gseditpro-lab train-starter: trains the embedded text-to-image model on the synthetic world.
#include <filesystem>
#include <memory>

#include "app/laboratory/laboratory.h"
#include "engine/laboratory/training/picture_shards.h"
#include "engine/laboratory/training/starter_plugin.h"
#include "engine/laboratory/training/starter_source.h"
#include "engine/laboratory/training/training_record.h"

namespace gse::app {
namespace {

struct TrainingOptions {
    StarterTrainParameters parameters;
    std::filesystem::path work = ".training/starter", output = "assets/models/starter";
    bool record = false, pictures_only = false;
};

}  // namespace

void add_training_command(CLI::App& app, CommandContext& context) {
    auto options = std::make_shared<TrainingOptions>();
    auto* command =
        app.add_subcommand("train-starter", "Train the embedded starter model on the synthetic world");
    command
        ->add_option("--work", options->work, "Folder of pictures, checkpoints and logs; a run resumes there")
        ->capture_default_str();
    command->add_option("--out", options->output, "Diffusers folder to write")->capture_default_str();
    command->add_flag("--record", options->record,
                      "Train nothing: draw curves and samples of the model in --out anew");
    command->add_flag(
        "--pictures-only", options->pictures_only,
        "Train nothing: draw the pictures of new shapes into --work, for packaging/train_shapes");
    bind_fields(*command, options->parameters, "Training");
    command->callback([options, &context] {
        if (options->record) return write_training_record(options->work, options->output, context.job());
        if (options->pictures_only)
            return write_picture_shards(options->parameters, options->work, context.job());
        const auto source = make_starter_source(options->parameters.seed);
        train_starter_in_plugin(options->parameters, *source, options->work, options->output, context.job());
        write_training_record(options->work, options->output, context.job());
    });
}

}  // namespace gse::app
