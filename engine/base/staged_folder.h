// A folder of results that belong together: seen whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace gse {

/// What a command leaves in its folder.
struct FolderContents {
    /// JSON file whose "files" (from listing()) names the others; it is written last.
    std::string report;
    /// Files and folders that will be written. One that is there and would be lost is refused before the
    /// work.
    std::vector<std::string> names;
};

/// Results are written to path(), a hidden folder inside the target (beside it when there is no target yet),
/// and appear under their names only with commit(). What killed runs left there is removed. If the object
/// dies before, so does path(), unless keep_on_failure() was called.
class StagedFolder {
public:
    /// Throws Error (Unwritable) when the target cannot be written, or when one of the names is there as a
    /// link, is read-only, or does not come from an earlier run (there is no report).
    StagedFolder(const std::filesystem::path& target, FolderContents contents);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    const std::filesystem::path& path() const { return staging_; }
    /// Throws Error (Unwritable) when the disk has less room than that.
    void require_space(std::uint64_t bytes) const;
    /// From here on the work is too dear to be thrown away: what is in path() when the object dies without a
    /// commit is kept under a name beside the target, and a warning says so.
    void keep_on_failure() { keep_ = true; }
    /// Bytes and fingerprint of every file in path(), for the report.
    nlohmann::ordered_json listing() const;
    /// Puts everything in place: in one step where there was nothing or only files of an earlier run and the
    /// system can swap folders; else file by file, the report last. Files of others in the target stay.
    /// Throws Error (Unwritable); the results are kept then, and the message says where.
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
