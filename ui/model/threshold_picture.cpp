// Pixels of an attention map above a threshold, drawn over the render. Fast enough to follow a slider.
#include "ui/model/threshold_picture.h"

#include <algorithm>
#include <array>
#include <vector>

namespace gse::ui {
namespace {

constexpr std::array<float, 3> Tint{0.34f, 0.61f, 0.88f};  // the accent
constexpr float TintShare = 0.35f, DarkShare = 0.3f;

}  // namespace

ThresholdPicture threshold_picture(const Image& render, const Image& map, double threshold) {
    ThresholdPicture result;
    if (render.width <= 0 || render.height <= 0 || map.width <= 0 || map.height <= 0) return result;
    const int width = render.width, height = render.height;
    Mask kept(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            kept.at(x, y) =
                static_cast<double>(map.at(x * map.width / width, y * map.height / height, 0)) > threshold
                    ? 1
                    : 0;
    result.share = static_cast<double>(kept.count()) / static_cast<double>(render.pixel_count());
    result.picture = Image(width, height, 3);
    const int last = render.channels - 1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool inside = kept.at(x, y) != 0;
            const bool rim =
                inside && (x == 0 || y == 0 || x + 1 == width || y + 1 == height || kept.at(x - 1, y) == 0 ||
                           kept.at(x + 1, y) == 0 || kept.at(x, y - 1) == 0 || kept.at(x, y + 1) == 0);
            for (int c = 0; c < 3; ++c) {
                const float colour = render.at(x, y, std::min(c, last));
                const float tint = Tint[static_cast<std::size_t>(c)];
                result.picture.at(x, y, c) = rim      ? tint
                                             : inside ? colour * (1 - TintShare) + tint * TintShare
                                                      : colour * DarkShare;
            }
        }
    return result;
}

}  // namespace gse::ui
