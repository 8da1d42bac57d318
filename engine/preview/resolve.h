// From the light of a pixel to the colour shown: shaders/resolve.glsl in C++, for pictures the own rasterizer
// makes.
#pragma once

#include <array>
#include <cstdint>

#include "engine/preview/splat_renderer.h"

namespace gse::preview {

/// Sums over the splats of a pixel, before a background: rgb = sum(alpha T c), alpha = 1 - T, depth =
/// sum(alpha T z), value = sum(alpha T v).
struct Light {
    std::array<float, 3> rgb{};
    float alpha = 0, depth = 0, value = 0;
};

/// rgb with alpha, not premultiplied; alpha is 1 unless the display is transparent. `depth_middle` (world
/// units) has the middle colour in depth pictures. Modes that change the shape of splats resolve like beauty.
std::array<float, 4> resolve(const Light& light, const Display& display, float depth_middle);

/// The same as RGBA8: value * 255, rounded, clamped.
void resolve_bytes(const Light& light, const Display& display, float depth_middle, std::uint8_t* rgba);

/// Display::depth_scale, or the distance from the camera to the scene's robust middle.
float depth_scale(const GaussianSet& set, const Camera& camera, const Display& display);

}  // namespace gse::preview
