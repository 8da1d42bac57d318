// Files of a scene by their names, from a folder or a zip archive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/io/bytes/zip_archive.h"

namespace gse::io {

/// Files below one place. Names are relative to it, with "/" between folders; capitals do not matter where no
/// file has the very name.
class PartFiles {
public:
    virtual ~PartFiles() = default;
    /// Bytes of a file. Throws Error when it is missing, broken, outside of the place or larger than `most`.
    virtual std::vector<std::byte> read(const std::string& name, std::uint64_t most) const = 0;
    /// Bytes that the files take on the disk. Their claims are measured by it.
    virtual std::uint64_t stored_bytes() const = 0;
    /// Files of a folder below. It need not exist.
    virtual std::unique_ptr<PartFiles> below(const std::string& folder) const = 0;
};

/// Zip archive with its entries. At its root, a name without a folder finds a file anywhere.
class PartArchive : public PartFiles {
public:
    /// Files in the order of the archive.
    virtual std::span<const ZipEntry> entries() const = 0;
    /// The first `most` bytes of an entry, or as many as there are. Empty where it cannot be read.
    virtual std::string start_of(const ZipEntry& entry, std::size_t most) const = 0;
};

/// Files of a folder. `what` names the scene in messages ("the SOG scene").
std::unique_ptr<PartFiles> open_folder(const std::filesystem::path& folder, const std::string& what);
/// Files of an archive, whose bytes must outlive the result. `what` names it in messages ("the SOG archive").
/// `file_bytes` is the size of the file on the disk; 0 = that of the archive. Throws Error (Malformed).
std::unique_ptr<PartArchive> open_archive(std::span<const std::byte> bytes, const std::string& what,
                                          std::uint64_t file_bytes = 0);

/// True when the bytes begin like a zip archive.
bool is_zip(std::span<const std::byte> bytes);
/// ASCII letters in lower case.
std::string lower_case(std::string text);

}  // namespace gse::io
