// Two windows with one project: each sees that the other has it, and what the other has saved.
#pragma once

#include <cstdint>
#include <filesystem>

namespace gse {

/// Lock of a project's file, one per machine and user. Ends with its process, however that ends. Movable.
class ProjectLock {
public:
    /// Holds nothing.
    ProjectLock() = default;
    /// Takes the lock where nobody has it. A folder that cannot be written counts as free. Never throws.
    explicit ProjectLock(const std::filesystem::path& project);
    ~ProjectLock();
    ProjectLock(ProjectLock&& other) noexcept;
    ProjectLock& operator=(ProjectLock&& other) noexcept;

    /// True where another window had the project when the lock was asked for.
    bool refused() const { return refused_; }

private:
    int descriptor_ = -1;
    bool refused_ = false;
};

/// Size and time of a file: another stamp = somebody wrote it.
struct FileStamp {
    std::uintmax_t size = 0;  // bytes
    std::filesystem::file_time_type time{};
    bool operator==(const FileStamp&) const = default;
};

/// Stamp of a file as it is now; all zero where there is none.
FileStamp stamp_of(const std::filesystem::path& file);

}  // namespace gse
