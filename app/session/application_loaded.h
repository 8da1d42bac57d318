// What the file thread read, on its way to the main thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/session/application.h"

namespace gse::app {

struct Application::Loaded {
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

}  // namespace gse::app
