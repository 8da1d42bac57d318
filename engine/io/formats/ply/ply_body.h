// Rows of a PLY body in any encoding, one at a time. Binary files without lists also by random access.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/io/formats/ply/ply_header.h"

namespace gse::io {

/// Scalar of a fixed-size row, converted to float.
float load_ply_scalar(const std::byte* source, PlyType type, bool big_endian);
/// Scalar of a fixed-size row. Doubles hold every type exactly.
double load_ply_double(const std::byte* source, PlyType type, bool big_endian);

/// Places of the scalars in a row of fixed size.
struct PlyRowShape {
    std::vector<PlyType> types;  // of each property; a list's does not count
    std::vector<std::size_t> offsets;
    std::size_t stride = 0;
    bool big_endian = false;
};

/// Shape of an element's rows in the file when they are binary and have no lists, else of the rows that
/// read_row() gives. Whole numbers of text are doubles there, since files write fractions in their place.
PlyRowShape row_shape(const PlyHeader& header, const PlyElement& element);

/// Walks the body of a PLY file element by element, in the order of the header. Throws Error if the file ends
/// early.
class PlyBody {
public:
    PlyBody(std::span<const std::byte> bytes, const PlyHeader& header);

    /// Skips everything before `element`, which must be one of the header's. Checks that its rows can fit in
    /// the rest.
    void seek(const PlyElement& element);
    /// Next row of `element`, of any encoding, into `shape.stride` bytes. Lists are left out.
    void read_row(const PlyElement& element, const PlyRowShape& shape, std::byte* row);
    /// All rows of a binary element without lists. The cursor moves behind them.
    std::span<const std::byte> take_rows(const PlyElement& element);

    std::size_t remaining() const { return bytes_.size() - offset_; }
    /// True when bytes other than blanks are left. Text files end in a newline.
    bool has_rest() const;
    /// Values of a text that are left.
    std::size_t words_left() const;
    /// Lines with values from the start of the last element that was sought.
    std::size_t lines_of_element() const;

private:
    void skip(const PlyElement& element);
    void skip_row(const PlyElement& element);
    void skip_list(const PlyProperty& property);
    std::span<const std::byte> take_scalar(PlyType type);
    double read_scalar(PlyType type);
    std::uint64_t read_list_size(PlyType type);
    std::string_view next_token();
    [[noreturn]] void throw_truncated() const;

    std::span<const std::byte> bytes_;
    const PlyHeader* header_;
    std::size_t offset_ = 0;
    std::size_t element_offset_ = 0;
    std::size_t next_element_ = 0;
};

}  // namespace gse::io
