// Segmenters that need no weights: GrabCut from clicks and a coarse hint, and a plain threshold of the hint.
#pragma once

#include <memory>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// Settings of GrabCutSegmenter. Lengths are shares of the image's width.
struct GrabCutParameters {
    int iterations = 4;
    double click_radius = 0.012;    // discs of certain pixels around the clicks
    double probable_inside = 0.5;   // hint above this: probably inside
    double certain_outside = 0.05;  // hint below this, and outside the box: certainly outside
    double box_margin = 0.08;       // growth of the box before what is outside counts as certain background
};

/// True when the program was built with OpenCV.
bool grabcut_available();

/// GrabCut (Rother et al. 2004) from clicks, box and hint; throws Error (Unsupported) without OpenCV.
/// Deterministic; the same marks on the same picture are answered from memory.
std::unique_ptr<Segmenter> make_grabcut_segmenter(const GrabCutParameters& parameters = {});

/// Inside where the hint is at least `level`, joined to the positive clicks.
std::unique_ptr<Segmenter> make_threshold_segmenter(double level = 0.5);

/// GrabCut where there is OpenCV, the threshold otherwise; may be called from several threads.
std::unique_ptr<Segmenter> make_default_segmenter();

}  // namespace gse::edit
