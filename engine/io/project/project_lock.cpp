// Lock files lie in the state folder, under a hash of the project's path.
#include "engine/io/project/project_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "engine/io/bytes/fingerprint.h"
#include "engine/io/files/user_files.h"

namespace gse {

ProjectLock::ProjectLock(const std::filesystem::path& project) {
    std::error_code failure;
    const auto folder = state_folder() / "locks";
    std::filesystem::create_directories(folder, failure);
    auto name = std::filesystem::weakly_canonical(project, failure);
    if (failure) name = project;
    const auto file = folder / fmt::format("{:016x}.lock", io::hash_bytes(name.string()));
    descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    refused_ = errno == EWOULDBLOCK;
    close(std::exchange(descriptor_, -1));
}

ProjectLock::~ProjectLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

ProjectLock::ProjectLock(ProjectLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), refused_(std::exchange(other.refused_, false)) {}

ProjectLock& ProjectLock::operator=(ProjectLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(refused_, other.refused_);
    return *this;
}

FileStamp stamp_of(const std::filesystem::path& file) {
    std::error_code failure;
    FileStamp stamp{std::filesystem::file_size(file, failure), {}};
    if (!failure) stamp.time = std::filesystem::last_write_time(file, failure);
    return failure ? FileStamp() : stamp;
}

}  // namespace gse
