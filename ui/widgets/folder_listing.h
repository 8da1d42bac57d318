// Entries of a folder in the file browser, and completion of typed paths. No drawing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace gse::ui {

struct FolderEntry {
    std::string name;  // UTF-8
    bool is_folder = false;
    std::uint64_t bytes = 0;
};

struct FolderListing {
    std::vector<FolderEntry> entries;  // folders first, each by name without regard to case
    std::string problem;               // why it cannot be read; empty = it could
    bool truncated = false;            // more than the browser shows
};

/// Files whose name ends in one of `extensions` (".ply"; empty = all). Hidden ones are left out.
FolderListing list_folder(const std::filesystem::path& folder, std::span<const std::string> extensions);

/// `typed` made longer as far as all names that begin with it agree. A single folder gets its slash. "~" is
/// the home.
std::string completed_path(const std::string& typed);

/// "~" and "~/x" to the home folder; others as they are.
std::filesystem::path expanded_path(const std::string& typed);

std::filesystem::path home_folder();
std::string utf8_of(const std::filesystem::path& path);
std::filesystem::path path_of(const std::string& utf8);
/// True when the name ends in one of them, in any case.
bool has_extension(const std::string& name, std::span<const std::string> extensions);
/// True for weights by their file's name (COLMAP's binaries are none), and for a folder that holds a model or
/// a LoRA by a file of its settings.
bool names_model(const std::filesystem::path& path);

}  // namespace gse::ui
