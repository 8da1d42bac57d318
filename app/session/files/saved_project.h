// The project's file: writes it, knows what it holds, and sees other windows that write it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/session/files/recovery.h"
#include "app/session/state/workspace.h"
#include "engine/io/project/project_file.h"
#include "engine/io/project/project_lock.h"

namespace gse::app {

/// Main thread only; files are written by the thread for files.
class SavedProject {
public:
    explicit SavedProject(Workspace& workspace) : workspace_(workspace) {}

    /// Takes the file of a document that was opened; empty = none. `holds` is what it holds of the document;
    /// nothing for recovered work. Returns false where another window has the file.
    bool begin(const std::filesystem::path& file, std::optional<Recovery::Moment> holds);
    /// Writes the file, then calls `then`. Where that would replace another window's work, asks first.
    void save(const std::filesystem::path& target, std::shared_ptr<ProjectData> data,
              const Recovery::Moment& now, std::function<void()> then);
    /// Asks whether to work on a copy, because another window has the file.
    void offer_copy(std::function<void(const std::filesystem::path&)> save_as);
    /// True when the file holds the document as it is at that moment.
    bool holds(const Recovery::Moment& moment) const { return holds_ == moment; }
    const std::string& saved_at() const { return saved_at_; }
    ProjectWriter& writer() { return *writer_; }

private:
    bool follow(const std::filesystem::path& file);
    std::string conflict(const std::filesystem::path& target) const;
    void write(const std::filesystem::path& target, std::shared_ptr<ProjectData> data,
               const Recovery::Moment& now, std::function<void()> then);

    Workspace& workspace_;
    std::unique_ptr<ProjectWriter> writer_ = std::make_unique<ProjectWriter>();
    std::filesystem::path file_;
    ProjectLock lock_;
    FileStamp stamp_;                        // when the file was read or written here
    std::optional<Recovery::Moment> holds_;  // what the file holds; none = not what is open
    std::string saved_at_;                   // "saved 14:02 (autosave on)"
};

}  // namespace gse::app
