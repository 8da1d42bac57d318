// Where tests find the shared third-party data, the reference numbers and a scratch folder. Absent data is a
// skip that CTest shows; where CI is set it is a failure.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace gse::test {

inline std::filesystem::path from_environment(const char* name, const std::filesystem::path& fallback) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != 0 ? std::filesystem::path(value) : fallback;
}

/// Third-party scenes and cameras (GSE_SHARED); the folder may be missing on a user's machine.
std::filesystem::path shared_folder();

/// Reference outputs of the networks (GSE_GOLDENS).
inline std::filesystem::path goldens_folder() {
    return from_environment("GSE_GOLDENS", shared_folder() / "goldens");
}

/// Reference outputs of the rasterizer, beside the networks' folder.
inline std::filesystem::path raster_goldens_folder() {
    const auto networks = goldens_folder() / "";  // so that "goldens" and "goldens/" have the same parent
    return networks.parent_path().parent_path() / "goldens_raster";
}

std::filesystem::path source_folder();
/// The build folder.
std::filesystem::path binary_folder();

/// True where a check that skips is a check that failed.
inline bool runs_in_ci() {
    const auto value = from_environment("CI", "").string();
    return !value.empty() && value != "false" && value != "0";
}

/// What was asked for and is not there. A program that skipped something returns SkipCode instead of success.
inline std::vector<std::filesystem::path>& skipped() {
    static std::vector<std::filesystem::path> paths;
    return paths;
}
constexpr int SkipCode = 77;  // as CTest is told in CMakeLists.txt

/// True when `path` exists; otherwise the case is to return: it counts as skipped, in CI as failed.
inline bool available(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return true;
    if (runs_in_ci())
        throw std::runtime_error(path.string() + " is not there, and CI is set: nothing may be skipped");
    std::printf("[skip] %s is not there\n", path.c_str());
    skipped().push_back(path);
    return false;
}

/// A fresh folder, removed with everything in it when the object dies.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "gse-test-XXXXXX").string();
        path_ = mkdtemp(pattern.data());
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace gse::test
