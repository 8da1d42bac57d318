// Places of the shared third-party data, the reference numbers and a scratch folder. Absent data is a skip
// that CTest shows; where CI is set it is a failure.
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

/// Reasons of the checks that were left out. A program with any returns SkipCode instead of success.
inline std::vector<std::string>& skipped() {
    static std::vector<std::string> reasons;
    return reasons;
}
constexpr int SkipCode = 77;  // as CTest is told in CMakeLists.txt

/// Counts a check that this machine cannot make (a processor without bfloat16): the case is to return.
inline void skip(const std::string& reason) {
    std::printf("[skip] %s\n", reason.c_str());
    skipped().push_back(reason);
}

/// Counts a check that lacks something every test machine has (data, a Vulkan device, a display, the
/// plug-in). The case is to return. Throws where CI is set.
inline void skip_missing(const std::string& reason) {
    if (runs_in_ci()) throw std::runtime_error(reason + ", and CI is set: nothing may be skipped");
    skip(reason);
}

/// True when `path` exists; otherwise the case is to return: it counts as skipped, in CI as failed.
inline bool available(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return true;
    skip_missing(path.string() + " is not there");
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
