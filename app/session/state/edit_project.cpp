// Locate, edit and apply, as steps of a document.
#include "app/session/state/edit_project.h"

#include <filesystem>
#include <utility>

#include "app/session/state/located_label.h"
#include "app/session/state/pending_result.h"

namespace gse::app {
ProjectData project_of(EditJob& job, const nlohmann::ordered_json& report) {
    return project_with({}, job, report);
}

ProjectData project_with(const ProjectData& earlier, EditJob& job, const nlohmann::ordered_json& report) {
    const auto scene = std::filesystem::absolute(job.recipe().job.scene);
    const bool first = earlier.state.base.empty();
    if (first && is_project_file(scene)) return project_with(load_project(scene), job, report);
    ProjectData project = earlier;
    if (first) project.source = scene_source(scene, job.scene().gaussians);
    const DocumentState before = first ? initial_state(job.scene(), {}) : earlier.state;
    PendingResult result;
    fill_pending(job, report, result);
    if (!job.knew_source()) result.label = located_label(job);  // else an earlier edit brought it
    project.state = applied(before, result, next_edit_id(before));
    project.thumbnail = result.thumbnail;
    project.ui["request"] = fields_to_json(job.recipe().request.plain());
    return project;
}

}  // namespace gse::app
