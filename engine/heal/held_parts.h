// Parts that only a thing held: they go with it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/heal/surface_rows.h"

namespace gse::heal {

/// Byte per row of `rest`: 1 for parts that nothing but the thing joins to the scene, by connected cells of
/// space. A part stays where it is larger than the thing, reaches as low as the thing's foot, or goes on
/// beyond the rows that were given.
std::vector<std::uint8_t> held_parts(std::span<const SurfaceRow> thing, std::span<const SurfaceRow> rest,
                                     const Body& body, double margin, const Vec3& up);

/// Byte per row of `loose`, which belong to no surface: 1 for small parts that touch the thing and lie within
/// its close surroundings, as a label leaves them out.
std::vector<std::uint8_t> remnants(std::span<const SurfaceRow> thing, std::span<const SurfaceRow> loose,
                                   const Body& body, double margin);

}  // namespace gse::heal
