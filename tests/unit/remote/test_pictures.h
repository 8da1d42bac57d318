// Pictures with structure for tests of servers: waves of three colours, discs, noise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/image.h"
#include "engine/base/random.h"

namespace remote_pictures {

using namespace gse;

/// Smooth picture [side,side,3] moved by (dx, dy) pixels and enlarged about its middle.
inline Image waves(int side, double dx = 0, double dy = 0, double scale = 1) {
    Image picture(side, side, 3);
    const double middle = (side - 1) / 2.0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double u = (x - dx - middle) / scale / side, v = (y - dy - middle) / scale / side;
            picture.at(x, y, 0) = static_cast<float>(0.5 + 0.3 * std::sin(23 * u + 5 * v) * std::cos(17 * v));
            picture.at(x, y, 1) = static_cast<float>(0.5 + 0.3 * std::sin(31 * v - 9 * u));
            picture.at(x, y, 2) = static_cast<float>(0.4 + 0.2 * std::cos(41 * u + 3) * std::sin(13 * v + 1));
        }
    return picture;
}

inline Mask disc(int side, double radius, double cx = -1, double cy = -1) {
    Mask mask(side, side);
    if (cx < 0) cx = cy = side / 2.0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            mask.at(x, y) = std::hypot(x + 0.5 - cx, y + 0.5 - cy) <= radius ? 1 : 0;
    return mask;
}

inline void paint(Image& picture, const Mask& mask, std::array<float, 3> colour) {
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0)
            std::copy(colour.begin(), colour.end(),
                      picture.data.begin() + static_cast<std::ptrdiff_t>(i * 3));
}

inline void add_noise(Image& picture, double deviation, std::uint64_t seed) {
    Random random(seed);
    for (auto& value : picture.data)
        value = std::clamp(value + static_cast<float>(deviation * random.normal()), 0.0f, 1.0f);
}

}  // namespace remote_pictures
