// What a run of locate or edit leaves in its folder.
#pragma once

#include <filesystem>
#include <string>

#include "app/edit_job.h"

namespace gse::app {

/// A folder that appears under its name only when commit() is called: everything is written to a hidden folder beside it
/// first, which disappears if the object dies before.
class StagedFolder {
public:
    /// Throws Error (Unwritable) when the place cannot be written.
    explicit StagedFolder(std::filesystem::path target);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;
    const std::filesystem::path& path() const { return staging_; }
    /// Moves every file to its place, replacing files of an earlier run.
    void commit();

private:
    std::filesystem::path target_, staging_;
    bool committed_ = false;
};

/// A map in [0,1] in colours: black, red, yellow, white.
Image heat_map(const Image& map);

/// Per view: render, attention map, points and mask as PNG, and index.json.
void write_evidence(const std::filesystem::path& folder, const edit::LocateResult& located,
                    const std::vector<View>& views);

/// The input as loaded, same row order, with label and label_weight columns.
void write_labelled_source(const std::filesystem::path& path, const EditJob& job);

/// A turn around both scenes (MP4) and four directions of it (PNG).
void write_before_after(const std::filesystem::path& folder, EditJob& job);

/// The report; `psnr_outside_db` pools all views of the edit.
nlohmann::ordered_json make_report(EditJob& job);

}  // namespace gse::app
