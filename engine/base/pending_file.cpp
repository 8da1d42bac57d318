// Steps of a safe write: temporary file, lock, checked writes, sync, rename.
#include "engine/base/pending_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "engine/base/file.h"
#include "engine/base/leftover.h"
#include "engine/base/log.h"

namespace gse {
namespace {

namespace fs = std::filesystem;

constexpr const char* TemporaryMark = ".tmp";  // ".NAME.tmpMARK.EXTENSION"
constexpr double ForeignAgeSeconds = 60;  // after which another machine's temporary file counts as given up
constexpr std::size_t LongestStem = 180;  // a name has 255 bytes, the mark needs some
constexpr std::size_t LongestExtension = 16;
constexpr int MostLinks = 40;  // as the kernel's
constexpr mode_t PermissionBits = 0777;

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Removes leftovers once per folder and process. Looking through a folder for every frame of a film would be
/// slow.
void tidy_once(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> seen;
    std::error_code failure;
    {
        const std::lock_guard lock(mutex);
        if (!seen.insert(fs::absolute(folder, failure)).second) return;
    }
    remove_stale_temporaries(folder);
}

/// Syncs a descriptor. Returns 0 or errno. Places that cannot sync (some network and virtual file systems)
/// count as done.
int sync_and_close(int descriptor) {
    int code = fsync(descriptor) != 0 ? errno : 0;
    if (code == EINVAL || code == ENOTSUP || code == EROFS) code = 0;
    if (close(descriptor) != 0 && errno != EINTR && code == 0) code = errno;
    return code;
}

}  // namespace

Error write_error(const std::string& what, int code, const fs::path& path) {
    const char* hint = "choose another place";
    if (code == ENOSPC || code == EDQUOT) hint = "free some space or choose another place";
    if (code == EFBIG)
        hint = "the limit for the size of a file is reached; raise it (ulimit -f) or choose another place";
    return {ErrorCode::Unwritable, fmt::format("{} cannot be written ({})", what, std::strerror(code)), hint,
            path};
}

fs::path end_of_links(fs::path path) {
    std::error_code failure;
    const fs::path start = path;
    for (int step = 0; fs::is_symlink(fs::symlink_status(path, failure)); ++step) {
        const fs::path next = fs::read_symlink(path, failure);
        if (failure || step == MostLinks)
            throw write_error("the link", failure ? failure.value() : ELOOP, start);
        path = folder_of(path) / next;  // an absolute `next` stands alone
    }
    return path;
}

void check_replaceable(const fs::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return;
    const auto refuse = [&](const char* message, const char* hint) {
        throw Error(ErrorCode::Unwritable, message, hint, path);
    };
    if (S_ISDIR(status.st_mode)) refuse("the output is a folder", "name a file");
    if (!S_ISREG(status.st_mode)) refuse("the output is a device or pipe", "name a file");
    // The mode, too: the superuser may write everything, but what is marked read-only is meant to stay.
    if ((status.st_mode & 0222) == 0 || (access(path.c_str(), W_OK) != 0 && errno == EACCES))
        refuse("the file is read-only", "choose another name, or make it writable first");
    if (status.st_nlink > 1)
        log::warning("{} has {} names; the others keep the content of before", path.string(),
                     status.st_nlink);
}

void sync_folder(const fs::path& folder) {
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    static_cast<void>(fsync(descriptor));
    close(descriptor);
}

PendingFile::PendingFile(const fs::path& path) : path_(path), target_(end_of_links(path)) {
    const fs::path folder = folder_of(target_);
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure)
        throw Error(ErrorCode::Unwritable, "the folder cannot be made (" + failure.message() + ")",
                    "choose another place", folder);
    check_replaceable(target_);
    tidy_once(folder);
    std::string stem = path.stem().string(), extension = path.extension().string();
    stem.resize(std::min(stem.size(), LongestStem));
    if (extension.size() > LongestExtension) extension.clear();
    do {
        temporary_ = folder / fmt::format(".{}{}{}{}", stem, TemporaryMark, writer_mark(), extension);
        descriptor_ = open(temporary_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) throw write_error("the file", errno, path_);
    hold(descriptor_);
    struct stat status {};
    if (stat(target_.c_str(), &status) != 0) return;
    static_cast<void>(fchown(descriptor_, status.st_uid, status.st_gid));  // where that is allowed
    static_cast<void>(fchmod(descriptor_, status.st_mode & PermissionBits));
}

PendingFile::~PendingFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

void PendingFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t taken = ::write(descriptor_, bytes.data(), bytes.size());
        if (taken < 0 && errno == EINTR) continue;
        if (taken <= 0) throw write_error("the file", taken < 0 ? errno : ENOSPC, path_);
        bytes.remove_prefix(static_cast<std::size_t>(taken));
    }
}

void PendingFile::commit() {
    const int code = sync_and_close(std::exchange(descriptor_, -1));
    if (code != 0) throw write_error("the file", code, path_);
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) throw write_error("the file", errno, path_);
    temporary_.clear();
    sync_folder(folder_of(target_));
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path& temporary)>& write) {
    PendingFile file(path);
    write(file.temporary());
    file.commit();
}

void write_file(const fs::path& path, std::string_view bytes) {
    PendingFile file(path);
    file.write(bytes);
    file.commit();
}

void remove_stale_temporaries(const fs::path& folder) {
    std::error_code failure;
    fs::directory_iterator entry(folder, failure);
    for (; !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        const std::size_t at = name.rfind(TemporaryMark);
        if (!name.starts_with('.') || at == std::string::npos) continue;
        const std::size_t begin = at + std::strlen(TemporaryMark), end = name.find('.', begin);
        std::error_code ignored;
        if (is_left_over(entry->path(), std::string_view(name).substr(begin, end - begin), ForeignAgeSeconds))
            fs::remove(entry->path(), ignored);
    }
}

}  // namespace gse
