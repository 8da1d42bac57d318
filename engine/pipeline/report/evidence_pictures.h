// Evidence of a search, as pictures for the window, and its arrival while the search still runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/search/locate.h"

namespace gse::pipeline {

/// Attention in false colour (dark blue to yellow) over a dimmed render.
std::shared_ptr<const Image> coloured_map(const Image& render, const Image& map);

/// Mask tinted over a dimmed render.
std::shared_ptr<const Image> masked_picture(const Image& render, const Mask& mask);

/// Evidence of a search in one view. The pictures are made once, ready for the screen. Null pictures have not
/// come yet.
struct SeenView {
    std::string name;
    std::shared_ptr<const Image> render;        // [H,W,3]
    bool drawn = false;                         // it shows what was drawn into the view to see where it goes
    std::shared_ptr<const Image> map;           // [H,W,1] attention in [0,1]
    std::shared_ptr<const Image> map_coloured;  // [H,W,3] the map in false colour over the render
    std::shared_ptr<const Mask> mask;           // null until it is made
    std::shared_ptr<const Image> mask_picture;  // [H,W,3] mask over the render
    std::vector<edit::PointPrompt> points;
    std::string branch;  // what made the mask
    double captured = 0;
    bool failed = false;
    edit::ViewStep step = edit::ViewStep::Found;  // where it failed
    Camera camera;
};

SeenView seen_view(const View& view, const edit::ViewEvidence& evidence);
/// Evidence of a view after another threshold. Render and attention stay on the screen.
SeenView refreshed(SeenView shown, const edit::ViewEvidence& evidence);

}  // namespace gse::pipeline
