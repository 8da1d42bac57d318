// Sums of a pixel -> the shown colour, on the CPU, for pictures made by engine/raster. The formulas are those
// of shaders/resolve.glsl; a test holds both together.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/thread_pool.h"
#include "engine/preview/display.h"

namespace gse::preview {

/// Sums over the splats of a pixel, not normalised, without a background: colour [H,W,3]
/// (raster::Settings::background = 0), alpha [H,W,1]. Depth and value are [H,W,1], or null if the mode does
/// not need them.
struct LightSums {
    const Image* colour = nullptr;
    const Image* alpha = nullptr;
    const Image* depth = nullptr;  // Mode::Depth
    const Image* value = nullptr;  // tints and maps
};

/// True when the picture needs `value` (raster::Rasterizer::forward_values) or `depth`.
bool needs_value(const Display& display);
bool needs_depth(const Display& display);

/// Colour 0..1 with alpha, not premultiplied. `depth_scale` as in Display, > 0. `hatched`: the pixel is on a
/// line of the hatching.
struct PixelSums {
    float red = 0, green = 0, blue = 0, alpha = 0, depth = 0, value = 0;
};
std::array<float, 4> resolve_pixel(const PixelSums& sums, const Display& display, float depth_scale,
                                   bool hatched = false);

/// False colour of t in 0..1.
std::array<float, 3> map_colour(float t);

/// RGBA8, row by row. Centres, rings and ellipsoids look like beauty here, since they need another blend.
void resolve(const LightSums& sums, const Display& display, float depth_scale, ThreadPool& pool,
             std::vector<std::uint8_t>& rgba);

}  // namespace gse::preview
