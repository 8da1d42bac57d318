// Correcting labels by hand: rows under a region of the screen, set operations, growing, histogram. Pure
// functions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/thread_pool.h"
#include "engine/scene/document.h"

namespace gse {

/// What is drawn on the screen to select with, in pixels of the camera's image (pixel (0,0) has its centre at
/// (0.5, 0.5)).
struct ScreenArea {
    std::vector<std::array<float, 2>> polygon;  // closed, even-odd; used when not empty
    std::vector<std::array<float, 2>> circles;  // centres of a brush stroke; consecutive ones are joined
    float radius_px = 0;
};

/// Which rows under the area count.
struct PickOptions {
    /// [h,w,1] camera z per pixel, alpha-normalised (0 or not finite = nothing there), at any resolution of
    /// the same view; null = everything under the area, in front or behind.
    const Image* depth = nullptr;
    const Mask* mask = nullptr;  // of the same view at any resolution: rows outside of it do not count; null
                                 // = no more limits
    double depth_tolerance = 0.02;  // front: z <= depth * (1 + tolerance)
    double near = 0;  // nearer rows are not drawn and not picked; 0 = as they are drawn (depth_range.h)
    double least_opacity = 1.0 / 255;  // fainter rows cannot be seen and are not picked
    ThreadPool* pool = nullptr;        // null = the calling thread only
};

/// One byte per row, 1 where the projected centre lies in the area (to half a pixel) and inside the image.
std::vector<std::uint8_t> rows_in_area(const GaussianSet& set, const Camera& camera, const ScreenArea& area,
                                       const PickOptions& options = {});

enum class LabelOperation { Add, Remove, Intersect, Replace };

/// A label of `count` rows with nothing in it.
NamedLabel empty_label(std::string name, std::size_t count);

/// These change `manual` and `bits` only; `weight` stays. `rows` holds a byte per row.
NamedLabel combine(NamedLabel label, std::span<const std::uint8_t> rows, LabelOperation operation);
/// Rows that an edit of what is labelled has added: they belong to it as those do that the views are sure of,
/// and nobody set them by hand. A label without weights has no other way than that.
NamedLabel with_added(NamedLabel label, std::span<const std::uint8_t> added);
NamedLabel invert(NamedLabel label);
/// Nothing is labelled any more, whatever the weights say.
NamedLabel clear(NamedLabel label);
/// Drops every correction by hand: the weights decide again.
NamedLabel without_corrections(NamedLabel label);
/// Another threshold; the corrections by hand stay.
NamedLabel with_threshold(NamedLabel label, float threshold);

/// Distance within which rows count as neighbours of a label's rows: the median, over a sample of labelled
/// rows, of the distance to the 8th nearest row. 0 when nothing is labelled.
double growth_radius(const GaussianSet& set, std::span<const std::uint8_t> bits);

/// Labels rows within `radius` of a labelled row, `steps` times; negative steps take away labelled rows
/// within `radius` of one that is not. radius <= 0 = growth_radius.
NamedLabel grow(NamedLabel label, const GaussianSet& set, int steps, double radius = 0);

/// Rows per weight, for the window's slider; rows of weight exactly 0 (never seen under the mask) are counted
/// apart.
struct WeightHistogram {
    std::array<std::uint32_t, 256> bins{};  // bin i: weights in [i/256, (i+1)/256), the last one with 1
    std::size_t zeros = 0;
    std::uint32_t highest = 0;  // largest bin
};
WeightHistogram weight_histogram(const NamedLabel& label);

std::size_t count_labelled(const NamedLabel& label);

}  // namespace gse
