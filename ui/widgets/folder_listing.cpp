// Entries of a folder in the file browser, and completion of typed paths. No drawing.
#include "ui/widgets/folder_listing.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <system_error>

#include "engine/base/safetensors_header.h"

namespace gse::ui {
namespace {

constexpr std::size_t EntryLimit = 5000;

/// ASCII lower case; other letters stay, which is enough to sort and to compare endings.
std::string lowered(std::string text) {
    for (auto& letter : text)
        if (static_cast<unsigned char>(letter) < 128)
            letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

bool before(const FolderEntry& a, const FolderEntry& b) {
    if (a.is_folder != b.is_folder) return a.is_folder;
    const std::string first = lowered(a.name), second = lowered(b.name);
    return first != second ? first < second : a.name < b.name;
}

std::string common_start(const std::string& a, const std::string& b) {
    const auto [end, ignored] = std::mismatch(
        a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin());
    return {a.begin(), end};
}

}  // namespace

std::string utf8_of(const std::filesystem::path& path) {
    const auto text = path.u8string();
    return {text.begin(), text.end()};
}

std::filesystem::path path_of(const std::string& utf8) {
    return std::filesystem::path(std::u8string(utf8.begin(), utf8.end()));
}

std::filesystem::path home_folder() {
    for (const char* name : {"HOME", "USERPROFILE"}) {
        const char* value = std::getenv(name);
        if (value != nullptr && *value != 0) return path_of(value);
    }
    return std::filesystem::path("/");
}

std::filesystem::path expanded_path(const std::string& typed) {
    if (typed == "~") return home_folder();
    if (typed.starts_with("~/")) return home_folder() / path_of(typed.substr(2));
    return path_of(typed);
}

bool has_extension(const std::string& name, std::span<const std::string> extensions) {
    if (extensions.empty()) return true;
    const std::string low = lowered(name);
    return std::any_of(extensions.begin(), extensions.end(),
                       [&low](const std::string& end) { return low.ends_with(end); });
}

FolderListing list_folder(const std::filesystem::path& folder, std::span<const std::string> extensions) {
    FolderListing listing;
    std::error_code error;
    std::filesystem::directory_iterator iterator(
        folder, std::filesystem::directory_options::skip_permission_denied, error);
    if (error) {
        listing.problem = "This folder cannot be read: " + error.message();
        return listing;
    }
    for (; iterator != std::filesystem::directory_iterator(); iterator.increment(error)) {
        if (error) break;
        std::error_code ignored;
        FolderEntry entry{utf8_of(iterator->path().filename()), iterator->is_directory(ignored), 0};
        if (entry.name.starts_with(".")) continue;
        if (!entry.is_folder && !has_extension(entry.name, extensions)) continue;
        if (listing.entries.size() >= EntryLimit) {
            listing.truncated = true;
            break;
        }
        if (!entry.is_folder) entry.bytes = iterator->file_size(ignored);
        if (ignored) entry.bytes = 0;
        listing.entries.push_back(std::move(entry));
    }
    std::sort(listing.entries.begin(), listing.entries.end(), before);
    return listing;
}

std::string completed_path(const std::string& typed) {
    const auto slash = typed.find_last_of('/');
    const std::string folder_text = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
    const std::string begin = slash == std::string::npos ? typed : typed.substr(slash + 1);
    const auto listing = list_folder(folder_text.empty() ? "." : expanded_path(folder_text), {});
    std::string common;
    std::size_t fitting = 0;
    bool only_folder = false;
    for (const auto& entry : listing.entries) {
        if (!entry.name.starts_with(begin)) continue;
        common = fitting == 0 ? entry.name : common_start(common, entry.name);
        only_folder = entry.is_folder;
        ++fitting;
    }
    if (fitting == 0) return typed;
    return folder_text + common + (fitting == 1 && only_folder ? "/" : "");
}

bool names_model(const std::filesystem::path& path) {
    for (const char* of_cameras : {"cameras.bin", "images.bin", "points3D.bin", "rigs.bin", "frames.bin"})
        if (path.filename() == of_cameras) return false;
    std::error_code ignored;
    return is_safetensors_name(path) || is_pickle_name(path) ||
           has_extension(path.string(), std::vector<std::string>{".gguf"}) ||
           std::filesystem::is_regular_file(path / "model_index.json", ignored) ||
           std::filesystem::is_regular_file(path / "adapter_config.json", ignored);
}

}  // namespace gse::ui
