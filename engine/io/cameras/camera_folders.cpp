// Layouts of COLMAP workspaces, and the order in which they are looked through.
#include "engine/io/cameras/camera_folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "engine/io/bytes/letter_case.h"
#include "engine/io/cameras/any_case.h"

namespace gse::io {
namespace {

namespace fs = std::filesystem;

/// Places of a COLMAP model below a folder, the preferred one first: the nearest model, its first component,
/// undistorted pictures, text exports, models of distorted pictures. "#" stands for every folder that is
/// named by a number.
constexpr std::array ColmapPlaces = {"",
                                     "sparse/0",
                                     "sparse",
                                     "colmap/sparse/0",
                                     "sparse/#",
                                     "colmap/sparse",
                                     "colmap/sparse/#",
                                     "colmap",
                                     "colmap/0",
                                     "colmap_sparse/0",
                                     "colmap_sparse",
                                     "dense/0/sparse",
                                     "dense/sparse/0",
                                     "dense/sparse",
                                     "dense/#/sparse",
                                     "dense",
                                     "colmap/dense/0/sparse",
                                     "colmap/dense/sparse",
                                     "undistorted/sparse/0",
                                     "undistorted/sparse",
                                     "undistorted",
                                     "sparse_text/0",
                                     "sparse_text",
                                     "sparse_txt",
                                     "colmap_text",
                                     "colmap/sparse_text",
                                     "sparse/text",
                                     "text",
                                     "distorted/sparse/0",
                                     "distorted/sparse",
                                     "distorted/sparse/#",
                                     "distorted"};
constexpr std::array PlacesInSparse = {"", "#"};  // of a folder that is called sparse

std::optional<ColmapFiles> colmap_files(AnyCase& files, const fs::path& folder, std::string_view ending) {
    const auto cameras = files.find(folder, "cameras" + std::string(ending));
    const auto images = cameras ? files.find(folder, "images" + std::string(ending)) : std::nullopt;
    if (!images) return std::nullopt;
    return ColmapFiles{*cameras, *images, ending == ".bin"};
}

/// Folders that a place stands for; "#" in it is a number.
std::vector<fs::path> folders_at(AnyCase& files, const fs::path& folder, const fs::path& place) {
    std::vector<fs::path> found = {folder};
    for (const fs::path& part : place) {
        std::vector<fs::path> deeper;
        for (const fs::path& base : found) {
            if (part == "#") {
                const auto numbered = files.numbered(base);
                deeper.insert(deeper.end(), numbered.begin(), numbered.end());
            } else if (const auto there = files.find(base, part)) {
                deeper.push_back(*there);
            }
        }
        found = std::move(deeper);
    }
    return found;
}

/// Places to look through, by the name of the folder.
std::vector<const char*> places_in(const fs::path& folder) {
    std::error_code ignored;
    fs::path whole = fs::absolute(folder, ignored).lexically_normal();
    if (!whole.has_filename()) whole = whole.parent_path();
    std::vector<const char*> places(ColmapPlaces.begin(), ColmapPlaces.end());
    if (lower_case(whole.filename().string()).starts_with("sparse"))
        places.insert(places.end(), PlacesInSparse.begin(), PlacesInSparse.end());
    return places;
}

std::string several_models_text(const std::vector<std::string>& places) {
    return fmt::format("several COLMAP models are there: {} is taken, not {}; name another one to use it",
                       places.front(), fmt::join(places.begin() + 1, places.end(), ", "));
}

/// The preferred COLMAP model at or below `folder`.
std::optional<FoundCameras> find_colmap(AnyCase& files, const fs::path& folder) {
    std::vector<fs::path> seen;
    std::vector<std::string> places;
    std::optional<FoundCameras> first;
    for (const char* place : places_in(folder))
        for (const fs::path& candidate : folders_at(files, folder, place)) {
            if (std::find(seen.begin(), seen.end(), candidate) != seen.end()) continue;
            seen.push_back(candidate);
            auto model = colmap_files(files, candidate, ".bin");
            if (!model) model = colmap_files(files, candidate, ".txt");
            if (!model) continue;
            const fs::path relative = candidate.lexically_relative(folder);
            places.push_back(relative == "." ? "the folder itself" : relative.string());
            if (!first) first = FoundCameras{candidate, std::move(model), {}};
        }
    if (places.size() > 1) first->note = several_models_text(places);
    return first;
}

}  // namespace

std::optional<ColmapFiles> colmap_files(const fs::path& folder, std::string_view ending) {
    AnyCase files;
    return colmap_files(files, folder, ending);
}

std::optional<FoundCameras> find_in_folder(const fs::path& folder) {
    AnyCase files;
    const auto json = [&](const char* name) -> std::optional<FoundCameras> {
        const auto path = files.find(folder, name);
        return path ? std::optional(FoundCameras{*path, {}, {}}) : std::nullopt;
    };
    if (auto found = json("cameras.json")) return found;
    if (auto found = find_colmap(files, folder)) return found;
    if (auto found = json("transforms.json")) return found;
    return json("transforms_train.json");
}

}  // namespace gse::io
