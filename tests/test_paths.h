// Where tests find the shared third-party data, the reference numbers and a scratch folder; absent data is a skip.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace gse::test {

inline std::filesystem::path from_environment(const char* name, const std::filesystem::path& fallback) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != 0 ? std::filesystem::path(value) : fallback;
}

/// Third-party scenes and cameras (GSE_SHARED); the folder may be missing on a user's machine.
inline std::filesystem::path shared_folder() { return from_environment("GSE_SHARED", GSE_SHARED_DEFAULT); }

/// Reference outputs of the networks (GSE_GOLDENS).
inline std::filesystem::path goldens_folder() { return from_environment("GSE_GOLDENS", shared_folder() / "goldens"); }

/// Reference outputs of the rasterizer, beside the networks' folder.
inline std::filesystem::path raster_goldens_folder() { return goldens_folder().parent_path() / "goldens_raster"; }

inline std::filesystem::path source_folder() { return GSE_SOURCE_DIR; }

/// True when `path` exists; otherwise prints the line that a reader of the log looks for.
inline bool available(const std::filesystem::path& path) {
    if (std::filesystem::exists(path)) return true;
    std::printf("[skip] %s is not there\n", path.c_str());
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
