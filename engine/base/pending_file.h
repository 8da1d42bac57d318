// A new version of one file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace gse {

/// Error of a failed write: the cause in one sentence. `code` is errno.
Error write_error(const std::string& what, int code, const std::filesystem::path& path);

/// Target of a write to `path`: the end of the chain of links. Throws Error (Unwritable) for a chain without
/// end.
std::filesystem::path end_of_links(std::filesystem::path path);

/// Throws Error (Unwritable) when `path` must not be replaced: a folder, a device, a pipe, or read-only.
void check_replaceable(const std::filesystem::path& path);

/// Brings the names in a folder to the disk. Places that cannot do that are passed over.
void sync_folder(const std::filesystem::path& folder);

/// New content of a file, written under a temporary name beside it (same extension) and put in its place by
/// commit(). A link is followed: the file it leads to is replaced, the link stays. The mode of an existing
/// file stays. Missing parent folders are made. Files that killed writers left in the folder are removed.
class PendingFile {
public:
    /// Throws Error (Unwritable).
    explicit PendingFile(const std::filesystem::path& path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// Temporary name, for libraries that write by name. commit() brings their bytes to the disk, too.
    const std::filesystem::path& temporary() const { return temporary_; }
    /// Appends. Throws Error (Unwritable) with the system's reason.
    void write(std::string_view bytes);
    /// Puts the file in its place. Throws Error (Unwritable); the old file is as it was then.
    void commit();

private:
    std::filesystem::path path_, target_, temporary_;
    int descriptor_ = -1;
};

}  // namespace gse
