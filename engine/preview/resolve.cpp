// The same formulas as shaders/resolve.glsl, operation by operation.
#include "engine/preview/resolve.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/scene.h"
#include "shaders/shared.h"

namespace gse::preview {
namespace {

using Colour = std::array<float, 3>;

Colour mix(const Colour& a, const Colour& b, float t) {
    return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t};
}

/// Dark blue, violet, orange, pale yellow: lightness grows with t.
Colour map_colour(float t) {
    static constexpr std::array<Colour, 5> stops{{{0.05f, 0.04f, 0.20f},
                                                  {0.36f, 0.10f, 0.48f},
                                                  {0.78f, 0.24f, 0.36f},
                                                  {0.97f, 0.58f, 0.20f},
                                                  {0.98f, 0.95f, 0.62f}}};
    const float place = std::clamp(t, 0.0f, 1.0f) * 4.0f;
    const float stop = std::min(std::floor(place), 3.0f);
    const auto first = static_cast<std::size_t>(stop);
    return mix(stops[first], stops[first + 1], place - stop);
}

std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

}  // namespace

std::array<float, 4> resolve(const Light& light, const Display& display, float depth_middle) {
    const float inverse = light.alpha > 0 ? 1.0f / light.alpha : 0.0f;
    const Colour solid{light.rgb[0] * inverse, light.rgb[1] * inverse, light.rgb[2] * inverse};
    const float share = std::clamp(light.value * inverse, 0.0f, 1.0f);
    Colour shown = solid;
    float cover = light.alpha;
    if (display.mode == Mode::Depth) {
        const float z = light.depth * inverse;
        shown = map_colour(1.0f - z / (z + depth_middle));
    } else if (display.mode == Mode::Opacity) {
        shown = {light.alpha, light.alpha, light.alpha};
        cover = 1;
    } else if (display.mode >= Mode::LabelWeight) {
        const float grey =
            (solid[0] * 0.299f + solid[1] * 0.587f + solid[2] * 0.114f) * shaders::DimmedBeauty;
        shown = mix({grey, grey, grey}, map_colour(share), shaders::MapCoverage * (0.25f + 0.75f * share));
    } else if (display.tint_strength > 0) {
        shown = mix(solid, display.tint, share * display.tint_strength);
    }
    if (display.transparent) return {shown[0], shown[1], shown[2], cover};
    std::array<float, 4> result{0, 0, 0, 1};
    for (std::size_t c = 0; c < 3; ++c) result[c] = shown[c] * cover + display.background[c] * (1.0f - cover);
    return result;
}

void resolve_bytes(const Light& light, const Display& display, float depth_middle, std::uint8_t* rgba) {
    const auto colour = resolve(light, display, depth_middle);
    for (std::size_t c = 0; c < 4; ++c) rgba[c] = to_byte(colour[c]);
}

float depth_scale(const GaussianSet& set, const Camera& camera, const Display& display) {
    if (display.depth_scale > 0) return display.depth_scale;
    if (display.mode != Mode::Depth) return 1;
    const auto statistics = compute_statistics(set);
    const Vec3 middle = (statistics.robust_low + statistics.robust_high) * 0.5;
    return static_cast<float>(std::max(length(middle - camera.centre()), 1e-3));
}

}  // namespace gse::preview
