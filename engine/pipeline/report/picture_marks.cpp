// Coverage of a pixel by its distance from the mark.
#include "engine/pipeline/report/picture_marks.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace gse::pipeline {
namespace {

double distance_to(const PictureMark& mark, double px, double py) {
    if (mark.radius > 0) return std::abs(std::hypot(px - mark.from[0], py - mark.from[1]) - mark.radius);
    const double x = mark.to[0] - mark.from[0], y = mark.to[1] - mark.from[1];
    const double squared = x * x + y * y;
    const double along = (px - mark.from[0]) * x + (py - mark.from[1]) * y;
    const double t = squared > 0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
    return std::hypot(px - mark.from[0] - t * x, py - mark.from[1] - t * y);
}

/// Puts a colour of that alpha over a pixel of 3 or 4 channels.
void blend(float* pixel, int channels, const std::array<float, 4>& colour, float alpha) {
    const float below = channels == 4 ? pixel[3] : 1.0f;
    const float together = alpha + below * (1 - alpha);
    if (!(together > 0)) return;
    for (int c = 0; c < 3; ++c)
        pixel[c] = (colour[static_cast<std::size_t>(c)] * alpha + pixel[c] * below * (1 - alpha)) / together;
    if (channels == 4) pixel[3] = together;
}

/// First and last pixel of a range of a side, from coordinates that may be far outside or no numbers.
std::array<int, 2> pixels_of(double low, double high, int side) {
    if (!(low <= high)) return {0, -1};
    return {static_cast<int>(std::clamp(low, 0.0, static_cast<double>(side))),
            static_cast<int>(std::clamp(high, -1.0, side - 1.0))};
}

void draw_mark(Image& picture, const PictureMark& mark) {
    const double reach = mark.half_width + mark.radius + 1;
    const auto [x_low, x_high] = pixels_of(std::min(mark.from[0], mark.to[0]) - reach,
                                           std::max(mark.from[0], mark.to[0]) + reach, picture.width);
    const auto [y_low, y_high] = pixels_of(std::min(mark.from[1], mark.to[1]) - reach,
                                           std::max(mark.from[1], mark.to[1]) + reach, picture.height);
    for (int y = y_low; y <= y_high; ++y)
        for (int x = x_low; x <= x_high; ++x) {
            const double off = distance_to(mark, x + 0.5, y + 0.5);
            const double covered = std::clamp(mark.half_width + 0.5 - off, 0.0, 1.0);
            if (covered > 0)
                blend(&picture.at(x, y, 0), picture.channels, mark.colour,
                      mark.colour[3] * static_cast<float>(covered));
        }
}

}  // namespace

void draw_marks(Image& picture, std::span<const PictureMark> marks) {
    GSE_CHECK(picture.channels == 3 || picture.channels == 4);
    for (const auto& mark : marks) draw_mark(picture, mark);
}

}  // namespace gse::pipeline
