// Contribution of one view to a search.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/masks/search_outcome.h"

namespace gse::edit {

/// Everything one view contributed, for the window and the evidence pictures.
struct ViewEvidence {
    Image render;  // [H,W,3]
    Image drawn;   // [H,W,3] where the new thing was drawn into it, to see where it goes; else empty
    Image map;  // [H,W,1] attention of the word, maximum 1; 0 where a competing word the user gave has more
    Image competitor_margin;  // [H,W,1] how much more another named thing has, 0 = none; empty without one
    Mask region;              // thresholded and cleaned attention
    std::vector<PointPrompt> points;  // clicks handed to the segmenter
    Mask mask;                        // the view's vote, not dilated
    std::string
        branch;  // what made the mask: "text", "points", "attention", "drawn", "anchor", "label" or "none"
    double captured = 0;              // share of the region's attention inside the mask
    bool trusted = false;             // the mask trims the attention: a segmenter made it that is trusted
    bool failed = false;              // nothing was found: the view does not vote
    ViewStep step = ViewStep::Found;  // where it failed
};

}  // namespace gse::edit
