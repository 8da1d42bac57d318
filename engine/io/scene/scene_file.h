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
#include "engine/io/scene/reading_options.h"
#include "engine/scene/scene.h"

namespace gse {

/// Reads a scene file of any format in scene_formats(), an unpacked format (meta.json), a zip archive or gzip
/// stream with one scene inside, a SuperSplat project, or a folder. Folders
/// are an Inria output folder (highest iteration) or hold one scene file. Of levels of detail, the finest is
/// read. load_scene() reads projects too. Throws Error with one clear sentence.
///
/// Infinite opacity logits that come from 8-bit 0 or 255 are clamped. Values of PLY files are kept bit for
/// bit. Coordinates of PLY files far from the origin lose SceneInfo::offset.
Scene load_scene_file(const std::filesystem::path& path, const ReadingOptions& options = {});

/// Scene files of a folder by name, to ask which one is meant; packed ones (.ply.gz) where there are no
/// others. Empty for a folder that is a scene by itself
/// (SOG, Inria output). Throws Error when the folder cannot be read.
std::vector<std::filesystem::path> scenes_in_folder(const std::filesystem::path& folder);
/// True when load_scene_file() would find a scene in the folder. Throws Error when the folder cannot be read.
bool holds_scene(const std::filesystem::path& folder);

/// Reads a scene file in memory, wrapped or not. `name` only tells formats without a magic number (.splat).
/// Unpacked formats are readable this way inside of an archive.
Scene parse_scene(std::span<const std::byte> bytes, std::string_view name);

/// Rows of a written scene.
struct SavedRows {
    std::size_t written = 0;
    std::size_t left_out = 0;  // NaN and the like, which the format cannot hold
};

/// Writes the scene, atomically. The format's losses are measured on the written bytes and told with
/// log::warning, the worst error per field.
///
/// Throws Error: InvalidArgument for an unknown format, or for labels in a format without room for them;
/// Malformed when the format can hold none of its splats; Unwritable.
SavedRows save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options = {});

}  // namespace gse
