// Scenes, projects and autosaves that the file thread reads, on their way to the window.
#include "app/session/files/opened_work.h"

#include <algorithm>
#include <utility>

#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/scene/scene_loading.h"

namespace gse::app {
namespace {

/// Files to open in a folder that is no scene by itself.
std::vector<std::filesystem::path> files_of_folder(const std::filesystem::path& folder) {
    auto files = scenes_in_folder(folder);
    if (files.empty()) return files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() == ".gsep") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// False where the scene is not there any more.
bool read_project(OpenedWork& opened, const std::filesystem::path& scene) {
    opened.project = true;
    if (scene.empty()) {
        const ProjectSummary summary = read_project_summary(opened.path);
        if (!summary.scene_found) return opened.lost = summary.scene, false;
    }
    opened.data = gse::load_project(opened.path, scene);
    opened.found_elsewhere = !scene.empty();
    opened.state = opened.data.state;
    opened.notes = opened.data.warnings;
    return true;
}

void read_scene(OpenedWork& opened, const ReadingOptions& options) {
    auto [scene, views, notes, up] = load_scene_with_cameras(opened.path, {}, options);
    if (!up.empty() && !scene.info.up_unsure) notes.push_back(up);  // else a bar over the picture asks
    opened.data.source = scene_source(opened.path, scene.gaussians);
    opened.notes = std::move(notes);
    opened.state = initial_state(scene, std::move(views));
}

OpenedWork recover_work(const WorkToOpen& work, const JobControl& control) {
    OpenedWork opened;
    opened.path = work.path;
    control.report("recovering", 0, 0);
    for (const auto& found : find_recoverable())
        if (found.file == work.path) opened.recovered = found;
    if (!opened.recovered)
        throw Error(ErrorCode::NotFound, "the unsaved work is not there any more",
                    "it was recovered or discarded elsewhere", work.path);
    opened.project_path = opened.recovered->project;
    if (!read_project(opened, work.scene)) return opened;
    opened.pending = take_back_edit(opened.state, opened.data.jobs);
    opened.statistics = compute_statistics(opened.state.current);
    return opened;
}

}  // namespace

OpenedWork open_work(const WorkToOpen& work, const JobControl& control) {
    if (work.recovers) return recover_work(work, control);
    const auto& path = work.path;
    OpenedWork opened;
    opened.path = path;
    control.report("reading", 0, 0);
    if (!std::filesystem::exists(path))
        throw Error(ErrorCode::NotFound, "there is no such file", "check the name", path);
    if (std::filesystem::is_regular_file(path) && is_project_file(path)) {
        opened.project_path = path;
        if (!read_project(opened, work.scene)) return opened;
    } else {
        if (std::filesystem::is_directory(path)) opened.choices = files_of_folder(path);
        if (opened.choices.size() > 1) return opened;
        if (opened.choices.size() == 1) opened.path = opened.choices.front();
        read_scene(opened, work.options);
    }
    control.report("looking", 0, 0);
    opened.statistics = compute_statistics(opened.state.current);
    if (auto note = surroundings_note(opened.statistics); !note.empty() && !opened.project)
        opened.notes.push_back(std::move(note));
    return opened;
}

}  // namespace gse::app
