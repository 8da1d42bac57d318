// Pictures beside a camera file, by the paths that other systems and machines wrote.
#include "engine/io/cameras/picture_sizes.h"

#include <algorithm>
#include <array>
#include <vector>

#include "engine/base/error.h"

namespace gse::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t LongestPath = 4096;  // bytes; what Linux opens
constexpr std::array PictureEndings = {"", ".png", ".jpg", ".jpeg"};

/// The path with slashes between its parts, without a drive letter.
std::string with_slashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    const bool drive = path.size() > 2 && path[1] == ':' && path[2] == '/';
    return drive ? path.substr(2) : path;
}

/// Paths below the folder of the camera file: the whole one, then without its first parts.
std::vector<fs::path> places_of(const std::string& file_path) {
    const fs::path whole = fs::path(with_slashes(file_path)).lexically_normal();
    std::vector<fs::path> parts;
    for (const fs::path& part : whole.relative_path())
        if (part != "..") parts.push_back(part);
    std::vector<fs::path> places = {file_path, whole};
    for (std::size_t first = 0; first < parts.size(); ++first) {
        fs::path rest;
        for (std::size_t at = first; at < parts.size(); ++at) rest /= parts[at];
        places.push_back(rest);
    }
    if (!parts.empty()) places.push_back("images" / parts.back());
    return places;
}

std::optional<ImageSize> size_at(const fs::path& picture) {
    std::error_code ignored;
    if (!fs::is_regular_file(picture, ignored)) return std::nullopt;
    try {
        return read_image_size(picture);
    } catch (const Error&) {  // it may not be readable
        return std::nullopt;
    }
}

}  // namespace

std::optional<ImageSize> PictureSizes::find(const std::string& file_path) {
    if (folder_.empty() || file_path.empty() || file_path.size() > LongestPath) return std::nullopt;
    for (const fs::path& place : places_of(file_path))
        for (const char* ending : PictureEndings)
            if (const auto found = files_.find(folder_, place.string() + ending))
                if (const auto size = size_at(*found)) return size;
    return std::nullopt;
}

}  // namespace gse::io
