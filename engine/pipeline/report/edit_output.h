// Files that a run of locate or edit leaves in its folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

/// Colour of a value in [0,1]: black, red, yellow, white.
Image heat_map(const Image& map);

/// Per view: render, attention map, points and mask as PNG, and index.json.
void write_evidence(const std::filesystem::path& folder, ThreadPool& threads,
                    const edit::LocateResult& located, const std::vector<View>& views);

/// Writes the input as loaded, in its row order, with label and label_weight columns.
void write_labelled_source(const std::filesystem::path& path, const EditJob& job);

/// Writes the edited scene alone.
void write_edited_scene(const std::filesystem::path& path, const EditJob& job);

/// Writes the files of an edit but for its report: scene.ply, source.ply, recipe.json, evidence,
/// before_after.mp4 and .png.
void write_edit(const std::filesystem::path& folder, EditJob& job);

/// A turn around both scenes (MP4) and four directions of it (PNG).
void write_before_after(const std::filesystem::path& folder, EditJob& job);

/// Bytes that an edit writes, about: two scenes, pictures of one raw picture per view together, a film of a
/// tenth of its pixels.
std::uint64_t bytes_of_results(const EditJob& job);

/// Words that were looked for, confidence and outcome of a search.
void add_search(nlohmann::ordered_json& report, const EditJob& job);

/// The report of a search.
nlohmann::ordered_json locate_report(EditJob& job);

/// Report of an edit. `psnr_outside_db` pools all views of the edit.
nlohmann::ordered_json make_report(EditJob& job);

}  // namespace gse::pipeline
