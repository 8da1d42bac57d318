// POSIX memory maps and temporary-then-rename writes.
#include "engine/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "engine/base/error.h"

namespace gse {
namespace {

constexpr const char* TemporaryMark = ".tmp";  // ".NAME.tmpPROCESS-NUMBER.EXTENSION"

constexpr std::chrono::minutes LeastAge{1};     // of a temporary file that is given up

[[noreturn]] void throw_open_error(const std::filesystem::path& path) {
    const int reason = errno;
    if (reason == ENOENT) throw Error(ErrorCode::NotFound, "the file does not exist", "check the name", path);
    throw Error(ErrorCode::Unreadable, std::string("the file cannot be opened (") + std::strerror(reason) + ")", "", path);
}

std::filesystem::path temporary_beside(const std::filesystem::path& path) {
    static std::atomic<unsigned> counter{0};
    return path.parent_path() / fmt::format(".{}{}{}-{}{}", path.stem().string(), TemporaryMark, getpid(), counter.fetch_add(1),
                                            path.extension().string());
}

/// Brings a file, or the names in a folder, to the disk. False when the device reports an error; places that cannot sync
/// (some network and virtual file systems) count as done.
bool sync_path(const std::filesystem::path& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return true;
    const bool failed = fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS;
    close(descriptor);
    return !failed;
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw_open_error(path);
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(descriptor);
        throw Error(ErrorCode::Unreadable, "this is not a regular file", "name a file", path);
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) {
        void* address = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
        if (address == MAP_FAILED) {
            close(descriptor);
            throw Error(ErrorCode::Unreadable, "the file cannot be mapped into memory", "", path);
        }
        data_ = static_cast<const std::byte*>(address);
    }
    close(descriptor);
}

MappedFile::~MappedFile() {
    if (data_ != nullptr) munmap(const_cast<std::byte*>(data_), size_);
}

MappedFile::MappedFile(MappedFile&& other) noexcept : data_(other.data_), size_(other.size_) {
    other.data_ = nullptr;
    other.size_ = 0;
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write) {
    std::error_code failure;
    if (path.has_parent_path()) {
        std::filesystem::create_directories(path.parent_path(), failure);
        if (failure)
            throw Error(ErrorCode::Unwritable, "the folder cannot be made (" + failure.message() + ")",
                        "choose another place", path.parent_path());
    }
    if (std::filesystem::is_directory(path, failure))
        throw Error(ErrorCode::Unwritable, "the output is a folder", "name a file", path);
    const std::filesystem::path temporary = temporary_beside(path);
    try {
        write(temporary);
    } catch (...) {
        std::filesystem::remove(temporary, failure);
        throw;
    }
    if (!sync_path(temporary)) {
        std::filesystem::remove(temporary, failure);
        throw Error(ErrorCode::Unwritable, "the disk did not take the file", "check the free space and the disk", path);
    }
    std::filesystem::rename(temporary, path, failure);
    if (failure) {
        const std::string reason = failure.message();
        std::filesystem::remove(temporary, failure);
        throw Error(ErrorCode::Unwritable, "the file cannot be written (" + reason + ")", "choose another place", path);
    }
    sync_path(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

void remove_stale_temporaries(const std::filesystem::path& folder) {
    std::error_code failure;
    std::filesystem::directory_iterator entry(folder, failure);
    for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        const std::size_t mark = name.rfind(TemporaryMark);
        if (!name.starts_with('.') || mark == std::string::npos) continue;
        long process = 0, number = 0;
        int used = 0;
        const char* rest = name.c_str() + mark + std::strlen(TemporaryMark);
        if (std::sscanf(rest, "%ld-%ld%n", &process, &number, &used) != 2 || process <= 0) continue;
        if (rest[used] != '\0' && rest[used] != '.') continue;
        std::error_code ignored;
        const auto age = std::filesystem::file_time_type::clock::now() - entry->last_write_time(ignored);
        if (ignored || age < LeastAge) continue;  // a shared folder: the writer may live on another machine
        if (kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) std::filesystem::remove(entry->path(), ignored);
    }
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        stream.close();
        if (!stream)
            throw Error(ErrorCode::Unwritable, std::string("the file cannot be written (") + std::strerror(errno) + ")",
                        "check the free space and the rights of the folder", path);
    });
}

std::string read_file(const std::filesystem::path& path) { return std::string(MappedFile(path).text()); }

}  // namespace gse
