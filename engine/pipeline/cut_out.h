// A thing on the screen, cut out of the picture: for labelling by hand.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/edit/interfaces.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/label_ops.h"

namespace gse::pipeline {

/// How the picture is taken, and what is picked in it.
struct CutOutRequest {
    Camera camera;
    ScreenArea area;             // around the thing, in the camera's pixels
    raster::Settings settings;   // of the picture, its background too
    bool front_only = true;      // what is behind the thing does not count
};

/// One byte per row of `set`: 1 for the thing. `segmenter` cuts it out of a picture of the view, told the box around the area; null = the
/// one that needs no weights. Where that comes to nothing, the area itself counts. With `front_only` these are the rows that are seen mostly
/// inside the outline (as in GSEditPro's labels, method S5) and together make up nearly all that is seen there; else all whose centres it holds.
std::vector<std::uint8_t> cut_out(const GaussianSet& set, const CutOutRequest& request, edit::Segmenter* segmenter);

}  // namespace gse::pipeline
