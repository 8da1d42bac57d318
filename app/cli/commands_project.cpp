// gseditpro project: what a project file holds, and its scene as a file.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/cli/cli.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/print.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_file.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/report/project_report.h"

namespace gse::app {
namespace {

const Label& find_label(const LabelSet& set, const std::string& name) {
    std::string names;
    for (const Label& label : set.labels) {
        if (label.name == name) return label;
        names += (names.empty() ? "" : ", ") + label.name;
    }
    throw Error(ErrorCode::InvalidArgument, fmt::format("the project has no label \"{}\"", name),
                names.empty() ? "it has none at all" : "choose from " + names);
}

/// The scene with the edits that are on; `label`, when named, as columns.
std::size_t export_scene(const std::filesystem::path& project, const std::filesystem::path& output,
                         const std::string& label) {
    const Scene scene = load_scene(project);
    SaveOptions save;
    if (!label.empty()) save.from_label = &find_label(scene.labels, label);
    return save_scene(output, scene, save).written;
}

struct ProjectOptions {
    std::filesystem::path input, output;
    std::string label;
    bool json = false;
};

}  // namespace

void add_project_command(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<ProjectOptions>();
    auto* command = app.add_subcommand("project", "Print what a project holds, or write its edited scene");
    command->add_option("project", options->input, "Project file (.gsep)")->required();
    command->add_flag("--json", options->json, "Print JSON");
    auto* output = command->add_option("--export", options->output,
                                       "Write the scene with the edits that are on to this file");
    command
        ->add_option("--label", options->label,
                     fmt::format("With --export to a {}: this label as columns",
                                 in_words(extensions_that_keep(&io::SceneFormat::keeps_labels), "or")))
        ->needs(output);
    command->callback([options] {
        const ProjectSummary summary = read_project_summary(options->input);
        std::error_code ignored;
        if (!options->output.empty() && std::filesystem::equivalent(summary.scene, options->output, ignored))
            throw Error(ErrorCode::InvalidArgument, "the output is the scene that the project was made from",
                        "choose another name", options->output);
        if (!options->output.empty()) {
            const std::size_t splats = export_scene(options->input, options->output, options->label);
            if (!options->json) {
                print("{} splats written to {}\n", splats, options->output.string());
                return;
            }
        }
        if (options->json) print_json(project_json(summary, options->input));
        else fmt::print("{}", project_text(summary, options->input));
    });
}

}  // namespace gse::app
