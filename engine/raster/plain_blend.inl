// The one loop over splats and pixels of the plain rasterizer: splats front to back, each over its bounding
// box.
#include <algorithm>
#include <cmath>

#include "engine/raster/conventions.h"

namespace gse::raster::plain {

/// One blended pair.
struct Pair {
    std::size_t splat = 0;  // place in the list
    std::size_t pixel = 0;
    double dx = 0, dy = 0;  // centre - pixel
    double falloff = 0;     // exp(-sigma)
    double alpha = 0;
    bool clamped = false;  // alpha is at its limit
    double before = 0;     // transmittance in front of the pair
};

/// Values of a pair in the loop, blended or not, for callers that mark close decisions.
struct Decision {
    std::size_t pixel = 0;
    double unclamped_alpha = 0;
    double after = 0;  // transmittance behind the pair
};

/// Transmittance at which a pixel ends, with room for rounding. Behind two pairs at the alpha limit it is
/// (1 - 0.99)^2, exactly the cut. Both end the pixel as in float, however 1 - 0.99 is rounded.
constexpr double LastCut = TransmittanceCut * (1 + 1e-12);

template <class Visit, class Watch>
std::size_t walk_pairs(const SplatList& list, const Camera& camera, std::vector<double>& transmittance,
                       Visit&& visit, Watch&& watch) {
    const std::size_t width = static_cast<std::size_t>(camera.width);
    transmittance.assign(width * static_cast<std::size_t>(camera.height), 1.0);
    std::vector<std::uint8_t> finished(transmittance.size(), 0);
    std::size_t tested = 0;
    const auto first = [](double low) { return static_cast<int>(std::max(0.0, std::floor(low - 0.5))); };
    const auto last = [](double high, int size) {
        return static_cast<int>(std::min<double>(size - 1, std::ceil(high - 0.5)));
    };
    for (std::size_t i = 0; i < list.splats.size(); ++i) {
        const Splat& s = list.splats[i];
        const int x_end = last(s.x + s.half_width, camera.width),
                  y_end = last(s.y + s.half_height, camera.height);
        const int x_begin = first(s.x - s.half_width);
        for (int py = first(s.y - s.half_height); py <= y_end; ++py) {
            for (int px = x_begin; px <= x_end; ++px) {
                const std::size_t pixel = static_cast<std::size_t>(py) * width + static_cast<std::size_t>(px);
                if (finished[pixel] != 0) continue;
                ++tested;
                const double dx = s.x - (px + 0.5), dy = s.y - (py + 0.5);
                const double sigma = 0.5 * (s.a * dx * dx + s.c * dy * dy) + s.b * dx * dy;
                const double falloff = std::exp(-sigma);
                const double unclamped = s.opacity * falloff;
                const double alpha = std::min(AlphaLimit, unclamped);
                const double before = transmittance[pixel], after = before * (1 - alpha);
                watch(Decision{pixel, unclamped, after});
                if (sigma < 0 || alpha < AlphaCut) continue;
                if (after <= LastCut) {
                    finished[pixel] = 1;
                    continue;
                }
                visit(Pair{i, pixel, dx, dy, falloff, alpha, unclamped > AlphaLimit, before});
                transmittance[pixel] = after;
            }
        }
    }
    return tested;
}

template <class Visit>
void for_each_blended(const SplatList& list, const Camera& camera, std::vector<double>& transmittance,
                      Visit&& visit) {
    walk_pairs(list, camera, transmittance, visit, [](const Decision&) {});
}

}  // namespace gse::raster::plain
