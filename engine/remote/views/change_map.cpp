// Differences, box blur, Otsu's threshold (Otsu 1979).
#include "engine/remote/views/change_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace gse::remote {
namespace {

constexpr std::size_t Bins = 256;
constexpr double LeastLevel = 12.0 / 255;  // a smaller change is the server's error
constexpr double Softness = 0.25;          // of the threshold: width of the step from outside to inside

/// Mean over squares of 2 radius + 1 pixels, along one axis after the other.
Image box_blurred(const Image& image, int radius) {
    if (radius < 1) return image;
    const auto along = [radius](const Image& from, bool rows) {
        Image result(from.width, from.height, 1);
        const int length = rows ? from.width : from.height;
        for (int line = 0; line < (rows ? from.height : from.width); ++line)
            for (int i = 0; i < length; ++i) {
                const int first = std::max(0, i - radius), last = std::min(length - 1, i + radius);
                float sum = 0;
                for (int j = first; j <= last; ++j) sum += rows ? from.at(j, line, 0) : from.at(line, j, 0);
                (rows ? result.at(i, line, 0) : result.at(line, i, 0)) =
                    sum / static_cast<float>(last - first + 1);
            }
        return result;
    };
    return along(along(image, true), false);
}

/// Level in (0,1) that parts the values best into two classes.
double otsu_level(const std::array<double, Bins>& histogram, double count) {
    double sum = 0;
    for (std::size_t i = 0; i < Bins; ++i) sum += static_cast<double>(i) * histogram[i];
    double below = 0, sum_below = 0, best = -1;
    std::size_t level = 0;
    for (std::size_t i = 0; i + 1 < Bins; ++i) {
        below += histogram[i], sum_below += static_cast<double>(i) * histogram[i];
        const double above = count - below;
        if (below <= 0 || above <= 0) continue;
        const double distance = sum_below / below - (sum - sum_below) / above;
        const double between = below * above * distance * distance;
        if (between > best) best = between, level = i;
    }
    return (static_cast<double>(level) + 1) / Bins;
}

}  // namespace

Image change_map(const Image& before, const Image& after, double blur_px) {
    GSE_CHECK_EQ(before.data.size(), after.data.size());
    Image change(before.width, before.height, 1);
    for (std::size_t i = 0; i < change.data.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            change.data[i] =
                std::max(change.data[i], std::abs(before.data[i * 3 + c] - after.data[i * 3 + c]));
    return box_blurred(change, static_cast<int>(std::lround(blur_px)));
}

Image outline_of_change(const Image& change, const Mask& mask) {
    GSE_CHECK_EQ(change.data.size(), mask.data.size());
    std::array<double, Bins> histogram{};
    double count = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] == 0) continue;
        const auto bin = static_cast<std::size_t>(std::clamp(change.data[i], 0.0f, 0.999f) * Bins);
        histogram[bin] += 1, count += 1;
    }
    Image outline(change.width, change.height, 1);
    if (count == 0) return outline;
    const double level = std::max(LeastLevel, otsu_level(histogram, count));
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0)
            outline.data[i] =
                static_cast<float>(std::clamp(0.5 + (change.data[i] - level) / (Softness * level), 0.0, 1.0));
    return outline;
}

}  // namespace gse::remote
