// A new version of one file that appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace gse {

/// The error of a failed write: what and why in one sentence. `code`: errno.
Error write_error(const std::string& what, int code, const std::filesystem::path& path);

/// Where a write to `path` ends up: the end of the chain of links. Throws Error (Unwritable) for a chain
/// without end.
std::filesystem::path end_of_links(std::filesystem::path path);

/// Throws Error (Unwritable) when `path` is there and is not a file that may be replaced: a folder, a device
/// or pipe, or read-only.
void check_replaceable(const std::filesystem::path& path);

/// Brings the names in a folder to the disk; places that cannot do that are passed over.
void sync_folder(const std::filesystem::path& folder);

/// Written under a temporary name beside the file (same extension), put in its place by commit(). A link is
/// followed: the file it leads to is replaced, the link stays. The mode of a file that is there stays.
/// Missing parent folders are made; what killed writers left in the folder is removed.
class PendingFile {
public:
    /// Throws Error (Unwritable).
    explicit PendingFile(const std::filesystem::path& path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    /// For libraries that write by name; what they write is brought to the disk by commit(), too.
    const std::filesystem::path& temporary() const { return temporary_; }
    /// Appends. Throws Error (Unwritable) with the system's reason.
    void write(std::string_view bytes);
    /// Throws Error (Unwritable); the old file is as it was then.
    void commit();

private:
    std::filesystem::path path_, target_, temporary_;
    int descriptor_ = -1;
};

}  // namespace gse
