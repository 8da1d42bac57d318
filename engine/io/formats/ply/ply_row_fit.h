// Agreement of a PLY header with the size of its file.
#pragma once

#include <cstdint>

#include "engine/io/formats/ply/ply_body.h"
#include "engine/scene/gaussian_set.h"

namespace gse::io {

/// Rows of the vertices in the file, against those that the header describes.
enum class RowFit : std::uint8_t { Fits, MayBeLonger, Longer };

/// Fit of binary rows, by the bytes behind the header. A rest that is equally many bytes for every vertex
/// tells of a column that the header lacks, unless it is of whole rows.
RowFit row_fit(const PlyHeader& header, const PlyElement& vertex, std::uint64_t body_bytes);

/// Throws Error (Malformed) with the sizes of the rows.
[[noreturn]] void throw_longer_rows(const PlyHeader& header, const PlyElement& vertex,
                                    std::uint64_t body_bytes);

/// Throws Error (Malformed) when the lines of a text hold more values than the header says. The body stands
/// behind the last of the vertices.
void check_line_values(const PlyBody& body, const PlyElement& vertex);

/// True when most rows have values that splats have.
bool look_like_splats(const GaussianSpans& set);

}  // namespace gse::io
