// Drop of the resolution while the camera moves.
#pragma once

#include <algorithm>
#include <cmath>

namespace gse::preview {

/// Share of the full size that follows the measured time of frames. No formula knows the right size: part of
/// the time does not depend on it, and other work comes and goes. Few sizes, so that pictures keep their
/// memory.
class MovingScale {
public:
    static constexpr double FrameMs = 50;  // a frame may take this long while the camera moves
    // Each has 0.71 of the pixels of the one before; the last one 0.21 of the width.
    static constexpr int Levels = 10;

    /// Share of the full width and height.
    double scale() const { return std::exp2(-0.25 * level_); }

    /// Notes that a frame at `share` of the full size took `ms`.
    void learn(double ms, double share) {
        if (!(ms > 0)) return;
        const int measured = static_cast<int>(std::lround(-4 * std::log2(std::clamp(share, 0.01, 1.0))));
        if (ms > FrameMs) {
            const int steps = static_cast<int>(std::ceil(2 * std::log2(ms / FrameMs)));
            level_ = std::clamp(std::max(level_, measured + std::clamp(steps, 1, 4)), 0, Levels - 1);
        } else if (ms * PixelStep < Comfortable * FrameMs && measured <= level_) {
            const int steps = static_cast<int>(std::floor(2 * std::log2(Comfortable * FrameMs / ms)));
            level_ = std::clamp(std::min(level_, measured - std::clamp(steps, 1, 2)), 0, Levels - 1);
        }
    }

private:
    static constexpr double PixelStep = 1.4143, Comfortable = 0.9;
    int level_ = 4;
};

}  // namespace gse::preview
