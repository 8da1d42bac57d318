// The header of a PLY file: elements with typed properties, comments, and the start of the body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/origin/extra_columns.h"

namespace gse::io {

using PlyType = ColumnType;

inline std::size_t ply_type_size(PlyType type) { return column_type_size(type); }
/// Name in headers: "uchar".
const char* ply_type_name(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float32;
    bool is_list = false;
    PlyType count_type = PlyType::Uint8;  // of the list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    bool has_list() const;
    /// Bytes of a row without lists.
    std::size_t row_bytes() const;
    /// Least bytes of a row, since a list may be empty.
    std::size_t least_row_bytes() const;
    /// Index of the property, or -1.
    int find(std::string_view property) const;
};

enum class PlyEncoding : std::uint8_t { Ascii, LittleEndian, BigEndian };

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> comments;  // without the word "comment"
    std::size_t body_offset = 0;

    const PlyElement* find(std::string_view element) const;
};

/// Text without the byte order mark of UTF-8 at its start, which editors put there.
std::string_view without_mark(std::string_view text);

/// True when the bytes begin like a PLY file.
bool is_ply(std::span<const std::byte> bytes);

/// Parses a header. Accepts a byte order mark, LF, CRLF and lone CR line ends, padded lines, and both
/// spellings of the types. Throws Error (Malformed).
PlyHeader parse_ply_header(std::span<const std::byte> bytes);

}  // namespace gse::io
