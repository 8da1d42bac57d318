// Scene files: one call reads any supported format, one writes; the format is told by content first, then by
// name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace gse {

/// Reads a scene: 3DGS PLY, PlayCanvas compressed PLY, .splat, .spz (v1-v4), .sog (zip, folder or meta.json),
/// lod-meta.json (finest level), an Inria output folder (highest iteration) or any folder with one scene file
/// in it; of a project (.gsep) what it shows. Throws Error with one clear sentence. Infinite opacity logits
/// that come from 8-bit 0 or 255 are clamped; values of PLY files are kept bit for bit.
Scene load_scene(const std::filesystem::path& path);

/// The scene files of a folder by name, for asking which one is meant; empty for a folder that is a scene by
/// itself (SOG, Inria output). Throws Error when it cannot be read.
std::vector<std::filesystem::path> scenes_in_folder(const std::filesystem::path& folder);
/// Whether there is anything in the folder that load_scene() would read. Throws Error when it cannot be read.
bool holds_scene(const std::filesystem::path& folder);

/// Same for a file already in memory; `name` only helps to tell formats without a magic number (.splat).
/// Formats that are folders are not readable this way.
Scene parse_scene(std::span<const std::byte> bytes, std::string_view name);

/// What to write beside the Gaussians.
struct SaveOptions {
    /// "ply", "compressed.ply", "splat", "spz" or "sog"; empty = from the file's name.
    std::string format = {};
    /// Optional columns of a 3DGS PLY, each empty or one value per row; written as floats after rot_3.
    std::span<const float> label = {};
    std::span<const float> label_weight = {};
    /// Takes `label` and `label_weight` from this label instead (must have one value per row).
    const Label* from_label = nullptr;
    /// Version of a .spz file: 3 is what most programs read, 4 the newest (smaller), 2 for the oldest ones
    /// (coarser rotations).
    int spz_version = 3;
};

/// Rows of a written scene.
struct SavedRows {
    std::size_t written = 0;
    std::size_t left_out = 0;  // NaN and the like, which the format cannot hold
};

/// Writes the scene, atomically. Throws Error (InvalidArgument for an unknown format or labels in a format
/// that has no room for them, Malformed when the format can hold none of its splats, Unwritable). What the
/// format changed is measured on the written bytes and told with log::warning, worst error per field.
SavedRows save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options = {});

/// Names for SaveOptions::format, in the order a user should see them.
std::vector<std::string> writable_formats();

}  // namespace gse
