// Camera files in the usual places of a folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace gse::io {

/// The two files of a COLMAP model that hold its cameras.
struct ColmapFiles {
    std::filesystem::path cameras, images;
    bool binary = false;
};

/// The COLMAP model directly in `folder`, with files of that ending (".bin" or ".txt") in any case. Nothing
/// where one of the two is missing.
std::optional<ColmapFiles> colmap_files(const std::filesystem::path& folder, std::string_view ending);

/// Cameras of a folder: a JSON file, or the folder of a COLMAP model.
struct FoundCameras {
    std::filesystem::path path;
    std::optional<ColmapFiles> colmap;
    std::string note;  // which of several COLMAP models was taken; empty = there is one
};

/// The first of cameras.json, a COLMAP model, transforms.json and transforms_train.json in `folder`, in any
/// case. Models are looked for in the layouts that COLMAP and its users make.
std::optional<FoundCameras> find_in_folder(const std::filesystem::path& folder);

}  // namespace gse::io
