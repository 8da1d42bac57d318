// A part of space as a set of equal cubes.
#pragma once

#include <string>
#include <vector>

#include "engine/math/vec.h"

namespace gse::edit {

/// A set of equal cubes.
struct VoxelRegion {
    std::vector<Vec3> centres;  // world
    std::vector<Vec3> shell;    // those with a free face, which alone are seen; empty = not known
    double side = 0;            // of a cube, world units
    double agreement = 0;       // mean share, of the views that see the cubes, whose mask covers them
    // "attention" or the place: "top", "front", "neck", "around", "beside", "left", ...
    std::string origin = "none";
    bool empty() const { return centres.empty(); }
};

}  // namespace gse::edit
