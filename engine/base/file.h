// Reads that survive a file being cut off meanwhile, and writes that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace gse {

/// A file opened for reading at any place. Folders, pipes and devices are refused.
class InputFile {
public:
    /// Throws Error (NotFound, Unreadable).
    explicit InputFile(const std::filesystem::path& path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&&) = delete;

    /// Size in bytes when it was opened.
    std::uint64_t size() const { return size_; }
    /// Fills `target` with the bytes from `offset` on. Throws Error (Unreadable) when the disk fails or the
    /// file was cut off meanwhile.
    void read(std::uint64_t offset, std::span<std::byte> target) const;

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// A whole file, read into memory. Later changes on the disk do not matter; a memory map would end the
/// program when somebody cuts the file off. Throws Error (NotFound, Unreadable) or OutOfMemory.
class FileBytes {
public:
    explicit FileBytes(const std::filesystem::path& path);

    std::span<const std::byte> bytes() const { return {data_.get(), size_}; }
    std::string_view text() const { return {reinterpret_cast<const char*>(data_.get()), size_}; }

private:
    std::unique_ptr<std::byte[]> data_;
    std::size_t size_ = 0;
};

/// Calls `write` with a temporary name beside `path` (same extension), then renames it over `path`.
/// PendingFile has the rules. If `write` throws, the temporary file is removed and `path` is as it was.
/// Throws Error (Unwritable).
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Removes temporary files that killed writers left in the folder. Those of living writers stay. Never
/// throws.
void remove_stale_temporaries(const std::filesystem::path& folder);

/// Writes these bytes to `path`, atomically. Throws Error (Unwritable).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The first `most` bytes of a file, or all if it has fewer. Throws Error (NotFound, Unreadable).
std::string read_start(const std::filesystem::path& path, std::size_t most);

/// The whole file as a string. Throws Error (NotFound, Unreadable) or OutOfMemory.
std::string read_file(const std::filesystem::path& path);

}  // namespace gse
