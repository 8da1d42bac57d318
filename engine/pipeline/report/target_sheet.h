// The redrawn views of an edit as contact sheets: what was redrawn beside what the scene was fitted to.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/edit/interfaces/view_targets.h"
#include "engine/scene/scene.h"

namespace gse::pipeline {

/// One sheet per round; below each pair the name of its view (`views` are the plan's), and whether it was
/// dropped or redrawn.
Image target_sheet(const edit::ViewTargets& round, const std::vector<View>& views);

/// targets_0.png, ...: one per round.
void write_targets(const std::filesystem::path& folder, ThreadPool& threads,
                   const std::vector<edit::ViewTargets>& rounds, const std::vector<View>& views);
/// Names of views that no server has drawn, since its drawing ended early.
std::vector<std::string> missing_views(const std::vector<edit::ViewTargets>& rounds,
                                       const std::vector<View>& views);
/// [{"round", "file", "views": [{"view", "redrawn", "dropped"}]}], and "missing" for views that were not
/// drawn.
nlohmann::ordered_json targets_to_json(const std::vector<edit::ViewTargets>& rounds,
                                       const std::vector<View>& views);

}  // namespace gse::pipeline
