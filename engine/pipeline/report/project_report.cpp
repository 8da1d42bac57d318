// Scene, edits and labels of a project, line by line.
#include "engine/pipeline/report/project_report.h"

#include <fmt/format.h>

#include <utility>

#include "engine/base/json.h"
#include "engine/base/path_text.h"
#include "engine/base/printable.h"

namespace gse::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json edit_json(const EditNode& edit) {
    Json recipe = try_parse_json<Json>(edit.recipe);
    if (recipe.is_discarded()) recipe = edit.recipe;
    return {{"id", edit.id},
            {"name", edit.name},
            {"enabled", edit.enabled},
            {"strength", edit.strength},
            {"seconds", edit.seconds},
            {"psnr_outside_db", edit.psnr_outside_db},
            {"changed_outside_label", edit.changed_outside_label},
            {"recipe", std::move(recipe)}};
}

}  // namespace

Json project_json(const ProjectSummary& summary, const std::filesystem::path& path) {
    Json json;
    json["file"] = text_of_path(path.string());
    json["program"] = summary.program;
    json["scene"] = text_of_path(summary.scene.string());
    json["scene_found"] = summary.scene_found;
    json["splats"] = summary.splats;
    json["edits"] = Json::array();
    for (const EditNode& edit : summary.stack) json["edits"].push_back(edit_json(edit));
    json["labels"] = Json::array();
    for (const NamedLabel& label : summary.labels)
        json["labels"].push_back({{"name", label.name}, {"threshold", label.threshold}});
    json["active_label"] = summary.active_label;
    json["views"] = summary.views.size();
    return json;
}

std::string project_text(const ProjectSummary& summary, const std::filesystem::path& path) {
    std::string text = fmt::format(
        "{}\n  scene         {}{}\n  splats        {}\n  views         {}\n", printable(path.string()),
        summary.scene.empty() ? "inside the project" : printable(summary.scene.string()),
        summary.scene_found ? "" : " (not there)", summary.splats, summary.views.size());
    for (const EditNode& edit : summary.stack)
        text +=
            fmt::format("  edit {:<9}{}{}\n", edit.id, printable(edit.name), edit.enabled ? "" : " (off)");
    for (const NamedLabel& label : summary.labels)
        text +=
            fmt::format("  label         {} (threshold {:.3g})\n", printable(label.name), label.threshold);
    return text;
}

}  // namespace gse::pipeline
