// Scene files: one call reads any supported format, one writes. Content tells the format first, the name
// second.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/formats/save_options.h"
#include "engine/scene/scene.h"

namespace gse {

/// Reads a scene file or folder: 3DGS PLY, PlayCanvas compressed PLY, .splat, .ksplat, .spz (v1-v4), .sog
/// (zip, folder or meta.json), lod-meta.json (finest level), an Inria output folder (highest iteration) or
/// any folder with one scene file in it. Projects are read by load_scene(). Throws Error with one clear
/// sentence. Infinite opacity logits that come from 8-bit 0 or 255 are clamped; values of PLY files are kept
/// bit for bit.
Scene load_scene_file(const std::filesystem::path& path);

/// The scene files of a folder by name, for asking which one is meant; empty for a folder that is a scene by
/// itself (SOG, Inria output). Throws Error when it cannot be read.
std::vector<std::filesystem::path> scenes_in_folder(const std::filesystem::path& folder);
/// Whether there is anything in the folder that load_scene_file() would read. Throws Error when it cannot be
/// read.
bool holds_scene(const std::filesystem::path& folder);

/// Same for a file already in memory; `name` only helps to tell formats without a magic number (.splat).
/// Formats that are folders are not readable this way.
Scene parse_scene(std::span<const std::byte> bytes, std::string_view name);

/// Rows of a written scene.
struct SavedRows {
    std::size_t written = 0;
    std::size_t left_out = 0;  // NaN and the like, which the format cannot hold
};

/// Writes the scene, atomically. Throws Error (InvalidArgument for an unknown format or labels in a format
/// that has no room for them, Malformed when the format can hold none of its splats, Unwritable). What the
/// format changed is measured on the written bytes and told with log::warning, worst error per field.
SavedRows save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options = {});

}  // namespace gse
