// Numbered names of files.
#include "engine/io/files/free_path.h"

#include <fmt/format.h>

#include <string>

#include "engine/io/formats/scene_formats.h"

namespace gse {
namespace {

/// Ending of a file's name: all of a scene format's (".compressed.ply"), else the part from the last dot on.
std::string ending_of(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    const std::string lower = io::lower_case(file);
    for (const std::string& extension : readable_extensions())
        if (lower.ends_with(extension) && extension.size() > ending.size())
            ending = file.substr(file.size() - extension.size());
    return ending;
}

}  // namespace

std::filesystem::path first_free(const std::filesystem::path& wanted) {
    std::error_code ignored;
    const auto taken = [&](const std::filesystem::path& path) {
        if (!std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) return false;
        return !std::filesystem::is_directory(path, ignored) || !std::filesystem::is_empty(path, ignored);
    };
    const std::string file = wanted.filename().string();
    const std::string ending = ending_of(file);
    std::string stem = file.substr(0, file.size() - ending.size());
    int number = 2;
    const auto dash = stem.find_last_not_of("0123456789");
    const bool numbered = dash != std::string::npos && dash > 0 && stem[dash] == '-' &&
                          dash + 1 < stem.size() && stem.size() - dash < 8;
    if (numbered) {
        number = std::stoi(stem.substr(dash + 1)) + 1;
        stem.resize(dash);
    }
    auto path = wanted;
    for (; taken(path); ++number) path = wanted.parent_path() / fmt::format("{}-{}{}", stem, number, ending);
    return path;
}

}  // namespace gse
