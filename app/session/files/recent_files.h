// The files that were open last, each with a small picture that is kept in the folder of the state.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/session/state/workspace.h"
#include "engine/base/image.h"

namespace gse::app {

class RecentFiles {
public:
    using Draw = std::function<std::shared_ptr<const Image>()>;

    explicit RecentFiles(Workspace& workspace) : workspace_(workspace) { list(); }
    /// Puts the file first. `draw` makes its picture, on another thread.
    void add(const std::filesystem::path& path, Draw draw);
    /// Draws what is waiting for its picture. Once per frame.
    void refresh();
    void show(ui::DocumentPart& model) const;

private:
    void list();

    Workspace& workspace_;
    std::vector<std::string> paths_;                      // newest first
    std::vector<std::shared_ptr<const Image>> pictures_;  // of the first of them
    std::optional<std::pair<std::filesystem::path, Draw>> waiting_;
};

}  // namespace gse::app
