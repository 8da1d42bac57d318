// Columns of PLY rows, gathered into arrays.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/io/formats/ply/ply_body.h"

namespace gse::io {

/// Source of rows [begin, end). They stay in place until the next call.
using PlyRowSource = std::function<std::span<const std::byte>(std::size_t begin, std::size_t end)>;

/// Rows that a source is asked for at a time: 128 x 248 bytes stay in the cache.
constexpr std::size_t PlyBlockRows = 128;

/// Columns of a row, as property indices (Absent = `missing`), and the one array that they are appended to.
struct PlyTarget {
    std::vector<int> columns;
    std::vector<float>* floats = nullptr;
    std::vector<double>* doubles = nullptr;
    std::vector<std::byte>* bytes = nullptr;  // as little-endian numbers of `type`
    float missing = 0;
    PlyType type = PlyType::Float32;
};

/// Gathers `count` rows block by block, so that each destination is written once.
void read_ply_rows(const PlyRowSource& source, const PlyRowShape& shape, std::size_t count,
                   std::span<const PlyTarget> targets);

}  // namespace gse::io
