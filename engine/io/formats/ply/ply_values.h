// Numbers of PLY columns, decoded to the attributes of splats.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/io/formats/ply/ply_layout.h"
#include "engine/scene/scene.h"

namespace gse::io {

/// Decodes the numbers of all columns in place: halves, shares, bytes and colours. Says so in `warnings`.
void decode_values(GaussianData& data, const PlyElement& vertex, const PlyLayout& layout,
                   std::vector<std::string>& warnings);

/// Makes the 3D filter of Mip-Splatting [N] part of sizes and opacities. Sizes grow to sqrt(size^2 +
/// filter^2); the opacity falls as the volume grows.
void fuse_filter(GaussianData& data, std::span<const float> filter);

/// Positions [N,3] less an offset, as floats. The offset is `stated` where it suits, else world_offset().
struct NearPositions {
    Vec3 offset;
    std::vector<float> values;
};
NearPositions near_positions(std::span<const double> positions, const std::optional<Vec3>& stated);

}  // namespace gse::io
