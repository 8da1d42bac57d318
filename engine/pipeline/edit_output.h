// What a run of locate or edit leaves in its folder.
#pragma once

#include <filesystem>
#include <string>

#include "engine/pipeline/edit_job.h"

namespace gse::pipeline {

/// A map in [0,1] in colours: black, red, yellow, white.
Image heat_map(const Image& map);

/// Per view: render, attention map, points and mask as PNG, and index.json.
void write_evidence(const std::filesystem::path& folder, ThreadPool& threads, const edit::LocateResult& located,
                    const std::vector<View>& views);

/// The input as loaded, same row order, with label and label_weight columns.
void write_labelled_source(const std::filesystem::path& path, const EditJob& job);

/// A turn around both scenes (MP4) and four directions of it (PNG).
void write_before_after(const std::filesystem::path& folder, EditJob& job);

/// What was looked for, how sure it was found, and what it came to.
void add_search(nlohmann::ordered_json& report, const EditJob& job);

/// The report; `psnr_outside_db` pools all views of the edit.
nlohmann::ordered_json make_report(EditJob& job);

}  // namespace gse::pipeline
