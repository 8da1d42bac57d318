// Autosaves: copies of projects in the state folder, found again when their process died.
//
// Each is NAME.gsep, a whole project. NAME.json beside it names the writer (process, its start, the boot),
// the project and the scene. NAME is a hash of the project's path ("unsaved" without one) and a random id of
// the session.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "engine/io/project/project_file.h"

namespace gse {

/// Folder of the autosaves: state_folder()/autosave.
std::filesystem::path autosave_folder();

/// Autosave of one open document. Safe to use from any thread; one call at a time runs. Its destructor leaves
/// the files; a program that ends well calls discard().
class Autosave {
public:
    explicit Autosave(std::filesystem::path folder = autosave_folder());

    /// Writes an autosave. Atomic and safe against kill -9 at any moment: the newest or the one before can be
    /// recovered. `project_path` is the artist's own file, empty = none yet. Use the document's own writer so
    /// that little is compressed. Throws Error.
    void write(const ProjectData& project, const std::filesystem::path& project_path, ProjectWriter& writer);
    /// Removes the autosave. Call it when the work is saved elsewhere or not wanted.
    void discard();
    /// Leaves the last autosave to be offered again, though this process lives on. The next write begins
    /// another. Throws Error.
    void leave();
    /// Path of the last autosave; empty = none.
    std::filesystem::path path() const {
        const std::lock_guard lock(mutex_);
        return path_;
    }

private:
    mutable std::mutex mutex_;
    std::filesystem::path folder_;
    std::string session_;
    std::filesystem::path path_;
};

/// Autosave whose process is gone, or that was left. load_project(file) opens it.
struct Recoverable {
    std::filesystem::path file;
    std::filesystem::path project;  // where it was saved by the artist; empty = nowhere
    std::filesystem::path scene;
    std::int64_t saved_at = 0;  // seconds since 1970
};

/// Autosaves that nobody writes any more and that are newer than their project, newest first. Those older
/// than their project are removed. Never throws.
std::vector<Recoverable> find_recoverable(const std::filesystem::path& folder = autosave_folder());

/// Removes it. Call it when it was recovered and saved or autosaved anew, or is not wanted.
void discard(const Recoverable& recoverable);

}  // namespace gse
