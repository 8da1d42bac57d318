// gseditpro project: what a project file holds, and its scene as a file.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/cli.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/print.h"
#include "engine/io/project_file.h"
#include "engine/io/scene_io.h"
#include "engine/pipeline/project_report.h"

namespace gse::app {
namespace {

const NamedLabel& find_label(const ProjectData& project, const std::string& name) {
    for (const NamedLabel& label : project.state.labels)
        if (label.name == name) return label;
    std::string names;
    for (const NamedLabel& label : project.state.labels) names += (names.empty() ? "" : ", ") + label.name;
    throw Error(ErrorCode::InvalidArgument, fmt::format("the project has no label \"{}\"", name),
                names.empty() ? "it has none at all" : "choose from " + names);
}

/// The scene with the edits that are on; `label`, when named, as columns.
std::size_t export_scene(const std::filesystem::path& project_path, const std::filesystem::path& output,
                         const std::string& label) {
    const ProjectData project = load_project(project_path);
    Scene scene;
    scene.gaussians = project.state.current;
    scene.info = project.state.info;
    Label columns;
    SaveOptions save;
    if (!label.empty()) {
        const NamedLabel& chosen = find_label(project, label);
        const std::vector<float> none(scene.gaussians.size(), 0.0f);
        columns = {
            chosen.name,
            chosen.weight != nullptr ? chosen.weight : std::make_shared<const std::vector<float>>(none),
            chosen.bits};
        save.from_label = &columns;
    }
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
    auto* output = command->add_option("--export", options->output, "Write the scene with the edits that are on to this file");
    command->add_option("--label", options->label, "With --export to a .ply: this label as columns")
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
