// An object that one view has shown, followed around to its other sides.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::pipeline {

/// Rows of an object in a view.
struct SeenThing {
    Camera camera;
    Mask mask;                        // its outline there
    std::vector<std::uint8_t> front;  // [N] 1 for the rows that are seen of it
    std::vector<std::uint8_t> cone;   // [N] 1 for the rows whose centres the outline holds, at any depth
    Vec3 up{0, -1, 0};                // of the world: around it the views turn
};

/// Takes in rows that the outline encloses, if `possible`. A dark panel of an object before something dark is
/// no hole in it.
void close_holes(Mask& mask, const Mask& possible);

/// Byte per row of `set`: 1 for the object from all sides, found in views around it. In each view the rows
/// that count so far prompt `segmenter`, and its outline tells which rows count next (SA3D, Cen et al. 2023).
/// Only rows of `front`, and those of `cone` that are not too far behind it, can be the object. Occluded
/// views, and views whose outline is far from the expected one, do not vote. Rows that no view sees go with
/// their neighbours. Throws Error (Cancelled).
std::vector<std::uint8_t> follow_around(const GaussianSet& set, const SeenThing& seen,
                                        const raster::Settings& settings, edit::Segmenter& segmenter,
                                        Painter& painter, const JobControl& control);

}  // namespace gse::pipeline
