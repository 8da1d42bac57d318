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

/// Reads an archive whose bytes outlive it. Throws Error (Malformed) for bytes that are no archive. `what`
/// names the file in messages ("the project").
class ZipReader {
public:
    ZipReader(std::span<const std::byte> bytes, std::string what);
    ~ZipReader();
    ZipReader(ZipReader&&) noexcept;
    ZipReader& operator=(ZipReader&&) = delete;

    bool has(const std::string& name) const;
    /// The member's bytes, its checksum verified. Throws Error for a member that is missing, broken or larger
    /// than `most` bytes.
    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gse::io
