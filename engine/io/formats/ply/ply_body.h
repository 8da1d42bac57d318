// Rows of a PLY body in any encoding, one at a time, as floats. Binary files without lists also by random
// access.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/io/formats/ply/ply_header.h"

namespace gse::io {

/// Scalar of a fixed-size row, converted to float.
float load_ply_scalar(const std::byte* source, PlyType type, bool big_endian);

/// Walks the body of a PLY file element by element, in the order of the header. Throws Error if the file ends
/// early.
class PlyBody {
public:
    PlyBody(std::span<const std::byte> bytes, const PlyHeader& header);

    /// Skips everything before `element`, which must be one of the header's. Checks that its rows can fit in
    /// the rest.
    void seek(const PlyElement& element);
    /// Next row of `element`. values[i] belongs to property i; lists give 0. `values` may be empty to skip
    /// the row.
    void read_row(const PlyElement& element, std::span<float> values);
    /// All rows of a binary element without lists. The cursor moves behind them.
    std::span<const std::byte> take_rows(const PlyElement& element);

    std::size_t remaining() const { return bytes_.size() - offset_; }
    /// True when bytes other than blanks are left. Text files end in a newline.
    bool has_rest() const;

private:
    void skip(const PlyElement& element);
    float read_scalar(PlyType type);
    std::uint64_t read_list_size(PlyType type);
    std::string_view next_token();
    [[noreturn]] void throw_truncated() const;

    std::span<const std::byte> bytes_;
    const PlyHeader* header_;
    std::size_t offset_ = 0;
    std::size_t next_element_ = 0;
};

}  // namespace gse::io
