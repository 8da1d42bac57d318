// Reads by POSIX calls. Writes are in pending_file.cpp.
#include "engine/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/memory.h"

namespace gse {
namespace {

constexpr std::size_t LargestRead = std::size_t{1} << 30;  // bytes the system is asked for at once

[[noreturn]] void throw_open_error(const std::filesystem::path& path) {
    const int reason = errno;
    if (reason == ENOENT) throw Error(ErrorCode::NotFound, "the file does not exist", "check the name", path);
    throw Error(ErrorCode::Unreadable,
                std::string("the file cannot be opened (") + std::strerror(reason) + ")", "", path);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
    // Opening a pipe must not wait for a writer.
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) throw_open_error(path);
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(descriptor);
        throw Error(ErrorCode::Unreadable, "this is a folder, pipe or device, not a file that can be read",
                    "name a file", path);
    }
    descriptor_ = descriptor;
    size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() {
    if (descriptor_ >= 0) close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

void InputFile::read(std::uint64_t offset, std::span<std::byte> target) const {
    while (!target.empty()) {
        const ssize_t got = pread(descriptor_, target.data(), std::min(target.size(), LargestRead),
                                  static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            throw Error(ErrorCode::Unreadable,
                        std::string("the file cannot be read (") + std::strerror(errno) + ")",
                        "check the disk", path_);
        if (got == 0)
            throw Error(ErrorCode::Unreadable, "the file became shorter while it was read",
                        "another program is writing it; wait until it is done", path_);
        offset += static_cast<std::uint64_t>(got);
        target = target.subspan(static_cast<std::size_t>(got));
    }
}

FileBytes::FileBytes(const std::filesystem::path& path) {
    const InputFile file(path);
    require_memory(file.size(), "the file");
    size_ = static_cast<std::size_t>(file.size());
    data_ = std::make_unique_for_overwrite<std::byte[]>(size_);
    file.read(0, {data_.get(), size_});
}

std::string read_start(const std::filesystem::path& path, std::size_t most) {
    const InputFile file(path);
    std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(most, file.size())), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    return text;
}

std::string read_file(const std::filesystem::path& path) { return std::string(FileBytes(path).text()); }

}  // namespace gse
