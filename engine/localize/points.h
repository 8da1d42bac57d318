// Point prompts for a segmenter from an attention map (METHOD.md, Masks in a view).
#pragma once

#include <vector>

#include "engine/base/image.h"

namespace gse::localize {

/// A click in pixel coordinates, pixel centres at .5.
struct Point {
    double x = 0, y = 0;
    bool positive = true;
};

struct PointParameters {
    int positive = 5;
    int negative = 3;
    double positive_spacing = 0.15;      // of the region's diameter, at least 2 pixels of a 64-pixel map
    double negative_spacing = 8.0 / 64;  // of the map's width
    double negative_margin = 4.0 / 64;   // distance from the region, of the map's width
};

/// Clicks: highest values inside `region` with mutual distance (non-maximum suppression), then lowest values
/// away from it. Ties go to the pixel farther from the chosen positives, then to raster order. Fewer points
/// if there is no room.
std::vector<Point> choose_points(const Image& map, const Mask& region,
                                 const PointParameters& parameters = {});

/// Share of the map's mass inside `region` that `mask` captures. 0 when the region holds none.
double captured_mass(const Image& map, const Mask& region, const Mask& mask);

}  // namespace gse::localize
