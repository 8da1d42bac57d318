// Inputs of an edit: views, masks, labelled rows, seeds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/interfaces/voxels.h"
#include "engine/edit/request/request.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// Inputs of the loop.
struct EditPlan {
    std::vector<View> views;              // cameras at the size of the pictures
    std::vector<std::string> view_words;  // per view, or empty
    std::vector<double> azimuths;         // per view, as in EditView, or empty
    std::vector<double> elevations;       // of as many views
    std::vector<Mask> masks;              // per view, dilated: 1 = the picture may change here
    std::vector<std::uint8_t> label;      // [N] 1 = the row may change
    GaussianData seeds;                   // new rows (add mode), may be empty
    raster::Settings settings;
    EditMode mode = EditMode::Modify;
    VoxelRegion room;  // replace mode: where the new thing may be
    std::string
        drawn_colour;  // add mode: that of what the search has drawn, where it did and the sentence says none
};

}  // namespace gse::edit
