// Options of runs over the suite.
#include "app/laboratory/eval_settings.h"

#include <set>
#include <string>

#include "app/cli/cli.h"
#include "app/cli/model_options.h"
#include "engine/pipeline/models/model_settings.h"

namespace gse::app {
namespace {

/// The suite's own words, mode and seed are not asked for.
bool is_asked_for(const std::string& field) {
    return field != "source" && field != "prompt" && field != "target" && field != "mode" && field != "seed";
}

}  // namespace

void add_eval_settings(CLI::App& command, EditRecipe& settings) {
    add_model_options(command, settings.job);
    command.add_option("--device", settings.job.device, "Device of the networks: cpu or cuda")
        ->capture_default_str();
    command
        .add_option("--threads", settings.job.threads,
                    "Threads of the networks; another number may round differently")
        ->capture_default_str()
        ->check(CLI::Range(1, 256));
    const auto bind = [&](const std::string& group) {
        return [&command, group](const char* name, auto& value, const char* help, const auto&... range) {
            if (group == "Edit" && !is_asked_for(name)) return;
            add_field_option(command, option_name(name), value, help, range...)->group(group);
        };
    };
    edit::EditRequest::visit_fields(settings.request, bind("Edit"));
    neural::SdsParameters::visit_fields(settings.guidance, bind("Guidance (score distillation)"));
}

void apply_eval_model(const CLI::App& command, EditRecipe& settings) {
    std::set<std::string> given;
    note_given(command, settings.job, "job", given);
    note_given(command, settings.request, "request", given);
    note_given(command, settings.guidance, "guidance", given);
    note_given(command, settings.dreambooth, "dreambooth", given, "--dreambooth-");
    apply_profile(profile_of(settings.job), settings, given);
}

}  // namespace gse::app
