// Locate, edit and apply, as steps of a document.
#include "app/session/state/edit_project.h"

#include <filesystem>
#include <utility>

#include "app/session/state/located_label.h"
#include "app/session/state/pending_result.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

constexpr std::uint64_t FirstEdit = 1;

/// The label that the edit followed: what the words found, or what was labelled by hand.
DocumentState labelled(const DocumentState& opened, const EditJob& job) {
    const auto& located = job.located();
    const auto& source = located.mode == edit::EditMode::Add ? located.source_label : located.label;
    DocumentState state = with_located_label(opened, job, true);
    auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (count_labelled(label) == 0) label = combine(std::move(label), *source.bits, LabelOperation::Add);
    return state;
}

}  // namespace

ProjectData project_of(EditJob& job, const nlohmann::ordered_json& report) {
    return project_with({}, job, report);
}

ProjectData project_with(const ProjectData& earlier, EditJob& job, const nlohmann::ordered_json& report) {
    ProjectData project = earlier;
    const bool first = earlier.state.stack.empty();
    if (first)
        project.source =
            scene_source(std::filesystem::absolute(job.recipe().job.scene), job.scene().gaussians);
    const DocumentState before = labelled(first ? initial_state(job.scene(), {}) : earlier.state, job);
    PendingResult result;
    fill_pending(job, report, result);
    EditNode node = node_of(result);
    node.id = first ? FirstEdit : earlier.state.stack.back().id + 1;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(before.current, *before.row_ids, result.set, *result.base_to_new, node.id));
    project.state = with_result(before, std::move(node), result);
    project.thumbnail = result.thumbnail;
    project.ui["request"] = fields_to_json(job.recipe().request.plain());
    return project;
}

}  // namespace gse::app
