// Project files (*.gsep): one zip of a JSON description and compressed arrays. The scene's file is
// referenced, not copied, and found again when it moved with the project.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/scene/document.h"
#include "engine/scene/stack_edits.h"

namespace gse {

/// File that a document's base came from.
struct SceneSource {
    std::filesystem::path path;  // absolute; empty = none (synthetic): projects then hold the whole base
    std::uint64_t bytes = 0;
    std::uint64_t fingerprint = 0;  // of the size, the first and last MiB and pages in between
    GaussianSet loaded;             // as the file gave it; the base is stored as a difference from this
};

/// Takes the fingerprint of the scene (a file or a folder) that gave `loaded`. Throws Error when it cannot be
/// read.
SceneSource scene_source(const std::filesystem::path& path, GaussianSet loaded);

/// Contents of a project. Copies copy pointers, so that a project can be saved on another thread.
struct ProjectData {
    DocumentState state;
    SceneSource source;
    bool embeds = false;                                // the project holds its scene, whatever `source` is
    std::shared_ptr<const Image> thumbnail;             // a small picture of the scene; may be null
    std::vector<EditVariations> variations;             // of edits of the stack, which hold one of them
    nlohmann::json ui = nlohmann::json::object();       // of the window; not looked into
    nlohmann::json jobs = nlohmann::json::object();     // what ran or waits; not looked into
    nlohmann::json unknown = nlohmann::json::object();  // fields of newer versions, kept on saving
    std::vector<std::string> warnings;                  // of loading: the scene moved, changed...
};

/// Facts of a project, read without loading its scene.
struct ProjectSummary {
    std::string program;          // version that wrote it
    std::filesystem::path scene;  // where it was
    bool scene_found = false;
    std::uint64_t splats = 0;  // with the edits that are on
    SceneInfo info;
    std::vector<EditNode> stack;     // without deltas and pictures
    std::vector<NamedLabel> labels;  // without arrays
    int active_label = -1;
    std::vector<View> views;
    nlohmann::json ui, jobs;
    std::shared_ptr<const Image> thumbnail;  // null when there is none or this build reads no pictures
};

/// Saves projects. Arrays of the last save are not compressed again, so autosaves are cheap. Keep one writer
/// per document for saves and autosaves. Safe to use from any thread; one call at a time runs.
class ProjectWriter {
public:
    /// Saves atomically. After it, or after a crash at any moment, `path` holds the old or the new project.
    /// Throws Error.
    void save(const std::filesystem::path& path, const ProjectData& project);
    /// Bytes of the file. `path` only tells the start of relative paths.
    std::string pack(const std::filesystem::path& path, const ProjectData& project);

private:
    struct Member {
        std::weak_ptr<const void> of;  // the address may be used again once this is gone
        std::shared_ptr<const std::string> bytes;
        std::uint64_t used = 0;  // number of the save
    };
    friend class ProjectPacker;
    std::mutex mutex_;
    std::unordered_map<std::string, Member> members_;
    std::uint64_t saves_ = 0;
    std::filesystem::path warned_of_;  // scene that was said to be gone
};

/// Saves once, without a cache.
void save_project(const std::filesystem::path& path, const ProjectData& project);

/// Reads a project and its scene. The scene is looked for beside the project (by its relative path), at its
/// old place, and by name in the project's folder. With `scene`, it is that file, which must be the one that
/// the project was saved with. `warnings` tell unusual findings. Throws Error with one sentence.
ProjectData load_project(const std::filesystem::path& path, const std::filesystem::path& scene = {});

/// Reads a project from memory. It must hold its base, or its base is `base` (as its file gives it).
ProjectData parse_project(std::span<const std::byte> bytes, const GaussianSet* base = nullptr);

/// Scene that a project shows, with the edits that are on: splats, and labels, the active one first.
Scene scene_of_project(const ProjectData& project);

ProjectSummary read_project_summary(const std::filesystem::path& path);

/// True when the file looks like a project (by name, or by content).
bool is_project_file(const std::filesystem::path& path);

}  // namespace gse
