// Sides of a drawn box that cut through the thing in it.
#pragma once

#include <string>

#include "engine/base/image.h"
#include "engine/edit/interfaces/interfaces.h"

namespace gse::pipeline {

/// Alpha and depth [H,W,1] of a picture, as raster::ForwardOutput has them.
struct PictureDepth {
    Image alpha, depth;
};

/// Pixels that are opaque at about the depths of the mask's pixels. `focal` is in pixels.
Mask level_with(const Mask& mask, const PictureDepth& picture, double focal);

/// Sides of a box at which what it holds goes on.
struct CutSides {
    bool above = false, below = false, left = false, right = false;
    bool any() const { return above || below || left || right; }
};

/// Sides of `box` that cut through what `mask` shows. `level` holds the pixels that are opaque at the mask's
/// depths. A side cuts where it has the mask on its inner side and `level` beyond it, over at least 0.15 of
/// the mask's width or height.
CutSides cut_sides(const Mask& mask, const Mask& level, const edit::BoxPrompt& box);

/// Names the sides ("above and to the left"), but not the one below: a thing stands on something. Empty =
/// none.
std::string sides_text(const CutSides& sides);

}  // namespace gse::pipeline
