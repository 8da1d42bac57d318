// Folder of results that belong together: seen whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace gse {

/// Results that a command leaves in its folder.
struct FolderContents {
    /// JSON file whose "files" (from listing()) names the others. It is written last.
    std::string report;
    /// Files and folders that will be written. Existing ones that would be lost are refused before the work.
    std::vector<std::string> names;
};

/// Folder for results that appear under their names only with commit(). Until then they lie in path(), a
/// hidden folder inside the target (beside it if there is no target yet). Leftovers of killed runs are
/// removed. Without commit() the destructor removes path(), unless keep_on_failure() was called.
class StagedFolder {
public:
    /// Throws Error (Unwritable) when the target cannot be written. A name that is a link, read-only or not
    /// from an earlier run (there is no report) is refused, too.
    StagedFolder(const std::filesystem::path& target, FolderContents contents);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    const std::filesystem::path& path() const { return staging_; }
    /// Throws Error (Unwritable) when the disk has less room than `bytes`.
    void require_space(std::uint64_t bytes) const;
    /// Keeps unfinished results from here on. Without a commit, the destructor moves path() to a name beside
    /// the target, and a warning says so.
    void keep_on_failure() { keep_ = true; }
    /// Bytes and fingerprint of every file in path(), for the report.
    nlohmann::ordered_json listing() const;
    /// Puts everything in place. One step suffices for a new target, or for files of an earlier run if the
    /// system can swap folders. Otherwise file by file, the report last. Other files in the target stay.
    /// Throws Error (Unwritable); the results are kept then, and the message names their place.
    void commit();

private:
    void check_contents() const;
    bool take_free_name();
    bool swap_with_target(const std::vector<std::string>& files);
    void move_file_by_file(const std::vector<std::string>& files);
    void keep_results() noexcept;
    std::set<std::string> earlier_files() const;

    FolderContents contents_;
    std::filesystem::path target_, staging_, kept_,
        made_;  // made_: topmost of the folders made for the target
    int lock_ = -1;
    bool keep_ = false;
};

}  // namespace gse
