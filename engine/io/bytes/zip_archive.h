// Zip archives in memory: written from named members, read one member at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gse::io {

struct ZipMember {
    std::string name;
    std::string_view bytes;
    bool deflate = false;  // otherwise stored as it is
};

/// Bytes of the archive. Equal members give equal bytes.
std::string write_zip(std::span<const ZipMember> members);

/// Entry of an archive that is no folder.
struct ZipEntry {
    std::string name;         // "/" between folders, whatever the archive has
    std::uint64_t size = 0;   // unpacked, as the archive says
    std::uint64_t index = 0;  // in the archive
    bool locked = false;      // with a password
};

/// Reads an archive whose bytes outlive it. Throws Error (Malformed) for bytes that are no archive. `what`
/// names the file in messages ("the project"), and `hint` says what to do with a damaged one.
class ZipReader {
public:
    ZipReader(std::span<const std::byte> bytes, std::string what, std::string hint = ProjectHint);
    ~ZipReader();
    ZipReader(ZipReader&&) noexcept;
    ZipReader& operator=(ZipReader&&) = delete;

    bool has(const std::string& name) const;
    /// The member's bytes, its checksum verified. Throws Error for a member that is missing, broken or larger
    /// than `most` bytes.
    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const;

    /// Files in the order of the archive. Names that are given twice come twice.
    std::vector<ZipEntry> entries() const;
    /// Bytes of an entry, as read() gives them.
    std::vector<std::byte> read_entry(const ZipEntry& entry, std::uint64_t most) const;
    /// The first `most` bytes of an entry, or as many as there are. Empty where it cannot be read.
    std::string read_start(const ZipEntry& entry, std::size_t most) const;

private:
    static constexpr const char* ProjectHint =
        "the file is cut off or damaged; open an older copy or an autosave";
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gse::io
