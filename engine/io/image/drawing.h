// Text and lines on pictures, for charts and sheets.
#pragma once

#include <array>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse {

using DrawColour = std::array<float, 3>;  // red, green, blue in [0,1]

/// Writes Latin text with its left end and baseline at (x, y), in pixels. `height` is that of a capital
/// letter. Text outside the picture [H,W,3] is cut off. Draws nothing without OpenCV.
void draw_text(Image& image, double x, double y, const std::string& text, double height,
               const DrawColour& colour);

/// Width in pixels of draw_text()'s result.
double text_width(const std::string& text, double height);

/// Joins the points (x, y) by antialiased lines. Points that are not finite end a line.
void draw_polyline(Image& image, std::span<const std::array<double, 2>> points, double thickness,
                   const DrawColour& colour);

}  // namespace gse
