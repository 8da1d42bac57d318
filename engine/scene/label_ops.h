// Corrections of labels by hand: rows under a region of the screen, set operations, growing, histogram. Pure
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

/// Area drawn on the screen to select with, in pixels of the camera's image. Pixel (0,0) has its centre at
/// (0.5, 0.5).
struct ScreenArea {
    std::vector<std::array<float, 2>> polygon;  // closed, even-odd; used when not empty
    std::vector<std::array<float, 2>> circles;  // centres of a brush stroke; consecutive ones are joined
    float radius_px = 0;
};

/// Choice of the rows under the area.
struct PickOptions {
    /// Camera z [h,w,1] per pixel, alpha-normalised, at any resolution of this view. 0 or not finite =
    /// nothing there. Null = all rows under the area count, at any depth.
    const Image* depth = nullptr;
    const Mask* mask = nullptr;  // of the same view at any resolution: rows outside of it do not count; null
                                 // = no more limits
    double depth_tolerance = 0.02;  // front: z <= depth * (1 + tolerance)
    double near = 0;  // nearer rows are not drawn and not picked; 0 = as they are drawn (depth_range.h)
    double least_opacity = 1.0 / 255;  // fainter rows cannot be seen and are not picked
    ThreadPool* pool = nullptr;        // null = the calling thread only
};

/// Byte per row: 1 if the projected centre lies in the area (to half a pixel) and inside the image.
std::vector<std::uint8_t> rows_in_area(const GaussianSet& set, const Camera& camera, const ScreenArea& area,
                                       const PickOptions& options = {});

enum class LabelOperation { Add, Remove, Intersect, Replace };

/// The name, or the first of "name 2", "name 3", ... that no label has.
std::string free_label_name(const std::vector<NamedLabel>& labels, const std::string& name);

/// Empty label of `count` rows.
NamedLabel empty_label(std::string name, std::size_t count);

/// Set operations that change `manual` and `bits` only; `weight` stays. `rows` holds a byte per row.
NamedLabel combine(NamedLabel label, std::span<const std::uint8_t> rows, LabelOperation operation);
/// Adds rows that an edit of the label has added. They belong to it with full weight, not by hand. A label
/// without weights takes them by hand.
NamedLabel with_added(NamedLabel label, std::span<const std::uint8_t> added);
NamedLabel invert(NamedLabel label);
/// Labels nothing, whatever the weights are.
NamedLabel clear(NamedLabel label);
/// Drops every correction by hand: the weights decide.
NamedLabel without_corrections(NamedLabel label);
/// Sets another threshold for the weights as they are. Corrections by hand stay. A label with a field is
/// decided anew instead: app::at_threshold().
NamedLabel with_threshold(NamedLabel label, float threshold);

/// Probability [N] in [0,1] by the label's views, whatever its threshold. Its weights where that is not
/// known. May be null.
std::shared_ptr<const std::vector<float>> view_probability(const NamedLabel& label);

/// Radius within which rows count as neighbours of a label's rows. Median of the distance to the 8th nearest
/// row over a sample of labelled rows. 0 when nothing is labelled.
double growth_radius(const GaussianSet& set, std::span<const std::uint8_t> bits);

/// Labels rows within `radius` of a labelled row, `steps` times. Negative steps take away labelled rows
/// within `radius` of one that is not labelled. radius <= 0 = growth_radius.
NamedLabel grow(NamedLabel label, const GaussianSet& set, int steps, double radius = 0);

/// Histogram of the weights, for the window's slider. Rows of weight exactly 0 (never seen under the mask)
/// are counted apart.
struct WeightHistogram {
    std::array<std::uint32_t, 256> bins{};  // bin i: weights in [i/256, (i+1)/256), the last one with 1
    std::size_t zeros = 0;
    std::uint32_t highest = 0;  // largest bin
};
WeightHistogram weight_histogram(const NamedLabel& label);

std::size_t count_labelled(const NamedLabel& label);

/// Labels of a state as those of a scene with its current rows, in their order.
LabelSet label_set(const DocumentState& state);

}  // namespace gse
