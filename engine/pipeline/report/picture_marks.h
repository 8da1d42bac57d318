// Lines, discs and rings drawn over a picture.
#pragma once

#include <array>
#include <span>

#include "engine/base/image.h"

namespace gse::pipeline {

/// Line with round ends, disc (both ends equal), or ring (radius above 0). Pixels; the middle of the first
/// pixel is (0.5, 0.5).
struct PictureMark {
    std::array<double, 2> from{}, to{};
    double half_width = 0.5;
    std::array<float, 4> colour{};  // in [0,1], straight alpha
    double radius = 0;              // of a ring around `from`; its line is 2 * half_width wide
};

/// Draws them in their order, antialiased. picture: [H,W,3] in [0,1], or [H,W,4] with straight alpha.
void draw_marks(Image& picture, std::span<const PictureMark> marks);

}  // namespace gse::pipeline
