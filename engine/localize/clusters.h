// From one attention map to one clean region: threshold, DBSCAN on the pixel grid, small clusters dropped.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/image.h"

namespace gse::localize {

/// DBSCAN (Ester et al. 1996) over the set pixels of a mask, with distances between pixel centres.
struct DbscanParameters {
    double eps_px = 2;
    int min_samples = 4;  // neighbours within eps, the pixel itself included
};

/// Cluster of every pixel: -1 = not set or noise. Others are 0, 1, ... in raster order of each cluster's
/// first core pixel. A border pixel within reach of several clusters belongs to the lowest. Exact, O(pixels *
/// eps^2).
std::vector<int> dbscan(const Mask& mask, const DbscanParameters& parameters);

/// Byte per pixel: 1 if map > threshold. `map` is [H,W,1] with maximum 1.
Mask threshold_map(const Image& map, double threshold);

/// Keeps the cluster with the largest attention mass and those with at least `keep_mass` of that mass.
/// DBSCAN's noise is dropped. The result may be empty.
Mask clean_clusters(const Mask& mask, const Image& map, const DbscanParameters& parameters, double keep_mass);

/// Pixels of `open` that a path of neighbours (four each) within it joins to a pixel of `from`.
Mask flood_fill(const Mask& open, const Mask& from);

/// Set pixels and the pixels that they enclose.
Mask without_holes(const Mask& mask);

/// Set pixels grown by a disc of `radius_px` (negative: shrunk).
Mask dilate(const Mask& mask, double radius_px);

/// Smallest box of pixels that holds all set ones. Sides of 0 if none is set.
struct PixelBox {
    int left = 0, top = 0, width = 0, height = 0;
};
PixelBox bounds_of(const Mask& mask);

/// Intersection over union of the set pixels of two masks of one size. 0 when neither has any.
double mask_iou(const Mask& a, const Mask& b);

/// Nearest-neighbour copy at another size.
Mask resize_mask(const Mask& mask, int width, int height);

/// Area average (down) or bilinear (up) copy of [H,W,C] at another size.
Image resize_image(const Image& image, int width, int height);

}  // namespace gse::localize
