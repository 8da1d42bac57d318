// Columns of a PLY's vertices that hold the attributes of splats: under which names, and in which numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/formats/ply/ply_header.h"

namespace gse::io {

constexpr int Absent = -1;

/// Meaning of a column's numbers.
enum class PlyCoding : std::uint8_t {
    Value,      // the attribute's own value
    Half,       // bits of a 16-bit float
    Share,      // whole number, a share of the largest
    ByteColour  // 8-bit colour in place of its SH coefficient
};

/// Properties of the vertex element by their use, as indices; Absent = the file has none.
struct PlyLayout {
    int sh_degree = 0;
    bool colours = false;  // red, green, blue instead of f_dc
    std::vector<int> position, log_scale, rotation, opacity, sh, label, label_weight;
    std::vector<int> filter;  // filter_3D of Mip-Splatting
    std::vector<int> extra;   // numbers that nothing of the above takes
    std::vector<std::string> lists;
};

/// Finds the columns of all attributes. Names with the prefixes of CloudCompare count where the plain name is
/// missing. Adds what is unusual to `warnings`. Throws Error: Unsupported for points, meshes and anchors,
/// Malformed for coefficients with gaps.
PlyLayout find_ply_layout(const PlyHeader& header, const PlyElement& vertex,
                          std::vector<std::string>& warnings);

/// Meaning of a column of the vertices. Throws Error (Unsupported) for bytes that nothing is known of.
PlyCoding coding_of(const PlyElement& vertex, const PlyLayout& layout, int column);

/// Name without the prefixes "scalar_" and "scal_", however many it has.
std::string_view plain_name(std::string_view name);

}  // namespace gse::io
