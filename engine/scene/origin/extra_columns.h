// Columns of a scene's file that no attribute of the splats takes. They are kept for the next file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gse {

/// Type of a column's numbers.
enum class ColumnType : std::uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// Bytes of a number of the type.
std::size_t column_type_size(ColumnType type);

/// A number per row that the program does not use.
struct ExtraColumn {
    std::string name;
    ColumnType type = ColumnType::Float32;
    std::shared_ptr<const std::vector<std::byte>> values;  // [N] little-endian

    /// Number of rows.
    std::size_t size() const { return values->size() / column_type_size(type); }
};

using ExtraColumns = std::vector<ExtraColumn>;

/// Columns of other rows. Row i takes the values of row sources[i]; -1 = a new row, which gets zeros.
ExtraColumns gathered(const ExtraColumns& columns, std::span<const std::int64_t> sources);

/// Inverse of a map of rows: for each of `rows` rows the row that was put there, -1 = none. places[row] is
/// the new place of a row, -1 = removed.
std::vector<std::int64_t> sources_of(std::span<const std::int64_t> places, std::size_t rows);

/// Columns of the rows with keep[row] != 0, in order.
ExtraColumns filtered(const ExtraColumns& columns, std::span<const unsigned char> keep);

std::vector<std::string> names_of(const ExtraColumns& columns);

}  // namespace gse
