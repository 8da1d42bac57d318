// Evidence of which of six directions is up: what stands, what it stands on, and where light comes from.
#pragma once

#include <array>
#include <span>

#include "engine/scene/layout/solid_grid.h"

namespace gse {

constexpr std::size_t Directions = 6;

/// World axis with sign: x, -x, y, -y, z, -z.
Vec3 direction(std::size_t index);
/// "x", "-x" and so on.
const char* direction_name(std::size_t index);

/// Evidence for one direction as up.
struct UpEvidence {
    double light = 0;     // brightness of surfaces that face this way, against others of their colour nearby
    double stands = 0;    // distance of the centre of mass from the edge of the base, in widths of the scene
    double symmetry = 0;  // -1 = upper and lower half are mirrored, 0 = nothing of one is in the other
    double base = 0;      // log of the base's area over the top's
    double level = 0;     // share of the surfaces that are level
    double facing = 0;    // share of the surfaces that face this way, less those that face away
    double origin = 0;    // 1 = the base is at the origin, which lies in the middle of the other axes
    double ground = 0;    // share of the weight in a thin layer below everything
    double cover = 0;     // share of the low face of the box that this layer covers
};

std::array<UpEvidence, Directions> up_evidence(std::span<const SurfaceSample> samples, const SolidGrid& grid);

}  // namespace gse
