// Scenes, projects and autosaves that the file thread reads, on their way to the window.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/session/state/pending_result.h"
#include "engine/base/progress.h"
#include "engine/io/project/autosave.h"
#include "engine/io/project/project_file.h"
#include "engine/io/scene/reading_options.h"
#include "engine/scene/document.h"
#include "engine/scene/scene.h"

namespace gse::app {

struct OpenedWork {
    std::filesystem::path path;                  // scene or project
    std::vector<std::filesystem::path> choices;  // a folder with several: nothing was read
    bool project = false;
    std::optional<Recoverable> recovered;
    std::optional<PendingResult> pending;  // an edit that was not applied when the work was kept
    std::filesystem::path project_path;
    DocumentState state;
    ProjectData data;
    SceneStatistics statistics;
    std::vector<std::string> notes;
    bool found_elsewhere = false;  // the artist said where the scene is: the project does not know it yet
    std::filesystem::path lost;    // scene of the project that is not there any more: nothing was read
};

/// File to read, and how.
struct WorkToOpen {
    std::filesystem::path path;   // scene, project or folder; the autosave of recovered work
    std::filesystem::path scene;  // of the project, where it moved; empty = where the project says
    bool recovers = false;
    ReadingOptions options = {};
};

/// Reads a scene, a project, the one scene of a folder, or an autosave. Throws Error.
OpenedWork open_work(const WorkToOpen& work, const JobControl& control);

}  // namespace gse::app
