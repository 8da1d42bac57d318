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
};

/// Reads a scene, a project or the one scene of a folder. Throws Error.
OpenedWork open_work(const std::filesystem::path& path, const ReadingOptions& options,
                     const JobControl& control);
/// Reads the autosave in `file`. Throws Error.
OpenedWork recover_work(const std::filesystem::path& file, const JobControl& control);

}  // namespace gse::app
