// A thing that one view has shown, followed around to its other sides.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/pipeline/run/scene_tools.h"

namespace gse::pipeline {

/// What a view shows of a thing.
struct SeenThing {
    Camera camera;
    Mask mask;                        // its outline there
    std::vector<std::uint8_t> front;  // [N] 1 for the rows that are seen of it
    std::vector<std::uint8_t> cone;   // [N] 1 for the rows whose centres the outline holds, at any depth
    Vec3 up{0, -1, 0};                // of the world: around it the views turn
};

/// Takes in what the outline encloses, where it is `possible`: a dark panel of a thing before something dark
/// is no hole in it.
void close_holes(Mask& mask, const Mask& possible);

/// One byte per row of `set`: 1 for the thing from all sides. Views are taken around it; in each the rows
/// that count so far, as they are seen there, tell `segmenter` what to cut out, and its outline tells which
/// rows count next (SA3D, Cen et al. 2023). Only rows of `front` and those of `cone` that are not too far
/// behind it can be the thing. A view that something stands in the way of, or whose outline has little to do
/// with what was expected, does not vote. Rows that no view sees go with their neighbours. Throws Error
/// (Cancelled).
std::vector<std::uint8_t> follow_around(const GaussianSet& set, const SeenThing& seen,
                                        const raster::Settings& settings, edit::Segmenter& segmenter,
                                        Painter& painter, const JobControl& control);

}  // namespace gse::pipeline
