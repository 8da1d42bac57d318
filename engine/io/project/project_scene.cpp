// The scene that a project shows: its splats with the edits that are on, and its labels.
#include <algorithm>

#include "engine/io/project/project_file.h"
#include "engine/scene/label_ops.h"

namespace gse {

Scene scene_of_project(const ProjectData& project) {
    const auto& state = project.state;
    Scene scene;
    scene.gaussians = state.current;
    scene.info = state.info;
    scene.extra = current_columns(state);
    scene.labels = label_set(state);
    auto& labels = scene.labels.labels;
    if (state.active_label > 0 && state.active_label < static_cast<int>(labels.size()))
        std::rotate(labels.begin(), labels.begin() + state.active_label,
                    labels.begin() + state.active_label + 1);
    return scene;
}

}  // namespace gse
