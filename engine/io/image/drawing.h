// Text and lines on pictures, for charts and sheets.
#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse {

using DrawColour = std::array<float, 3>;  // red, green, blue in [0,1]

/// Writes Latin text with its left end and baseline at (x, y), pixels; `height` is that of a capital letter.
/// What lies outside the picture [H,W,3] is cut off. Without OpenCV nothing is drawn.
void draw_text(Image& image, double x, double y, const std::string& text, double height,
               const DrawColour& colour);

/// Width in pixels of what draw_text would draw.
double text_width(const std::string& text, double height);

/// Joins the points (x, y) by antialiased lines; points that are not finite end a line.
void draw_polyline(Image& image, std::span<const std::array<double, 2>> points, double thickness,
                   const DrawColour& colour);

}  // namespace gse
