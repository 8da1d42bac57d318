// Files: read-only memory maps, and writes that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace gse {

/// A whole file mapped read-only. Throws Error (NotFound, Unreadable). An empty file gives an empty span.
class MappedFile {
public:
    explicit MappedFile(const std::filesystem::path& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&&) = delete;

    std::span<const std::byte> bytes() const { return {data_, size_}; }
    std::string_view text() const { return {reinterpret_cast<const char*>(data_), size_}; }

private:
    const std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

/// Calls `write` with a temporary name beside `path` (same extension), then renames it over `path`.
/// If `write` throws, the temporary file is removed and `path` is as it was. Missing parent folders are made.
/// Throws Error (Unwritable).
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Removes temporary files that writers which died left in the folder (those whose process is gone,
/// a minute old at least). Never throws.
void remove_stale_temporaries(const std::filesystem::path& folder);

/// Writes these bytes to `path`, atomically.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The whole file as a string. Throws Error (NotFound, Unreadable).
std::string read_file(const std::filesystem::path& path);

}  // namespace gse
