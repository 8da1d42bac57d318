// Display modes on the CPU.
#include "engine/preview/resolve.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "shared.h"

namespace gse::preview {
namespace {

using Rgb = std::array<float, 3>;

constexpr std::size_t RowsAtOnce = 16;

float mix(float a, float b, float t) { return a + (b - a) * t; }

/// 8 bits as a UNORM image stores them. NaN gives 0.
std::uint8_t to_byte(float value) {
    const float clamped = value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
    return static_cast<std::uint8_t>(clamped * 255.0f + 0.5f);
}

bool tints(const Display& display) {
    return display.tint_strength > 0 && (display.mode <= Mode::Ellipsoids || display.mode == Mode::Labels);
}

float smoothstep(float low, float high, float value) {
    const float t = std::clamp((value - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/// The colour without its grey.
Rgb hue_of(const Rgb& colour) {
    const float grey = (colour[0] + colour[1] + colour[2]) / 3.0f;
    return {colour[0] - grey, colour[1] - grey, colour[2] - grey};
}

float dot(const Rgb& a, const Rgb& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Tint over a colour: its own, or its complement where the colour has the same hue.
Rgb tint_over(const Rgb& solid, const Rgb& tint) {
    const Rgb hue = hue_of(solid), own = hue_of(tint);
    const float chroma = std::sqrt(dot(hue, hue));
    const float cosine = dot(hue, own) / std::max(chroma * std::sqrt(dot(own, own)), 1e-6f);
    const float alike = smoothstep(shaders::OtherHue, shaders::OwnHue, cosine) *
                        smoothstep(shaders::LeastChroma, shaders::ClearChroma, chroma);
    return {mix(tint[0], 1.0f - tint[0], alike), mix(tint[1], 1.0f - tint[1], alike),
            mix(tint[2], 1.0f - tint[2], alike)};
}

/// Common case, simple enough for the compiler to vectorise.
void resolve_plain(const float* colour, const float* alpha, std::size_t count, const Rgb& background,
                   std::uint8_t* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const float light = 1.0f - alpha[i];
        for (std::size_t k = 0; k < 3; ++k)
            out[i * 4 + k] = to_byte(colour[i * 3 + k] + background[k] * light);
        out[i * 4 + 3] = 255;
    }
}

}  // namespace

bool needs_value(const Display& display) { return tints(display) || display.mode >= Mode::LabelWeight; }
bool needs_depth(const Display& display) { return display.mode == Mode::Depth; }

Rgb map_colour(float t) {
    static constexpr Rgb stops[5] = {{0.05f, 0.04f, 0.20f},
                                     {0.36f, 0.10f, 0.48f},
                                     {0.78f, 0.24f, 0.36f},
                                     {0.97f, 0.58f, 0.20f},
                                     {0.98f, 0.95f, 0.62f}};
    const float place = std::clamp(t, 0.0f, 1.0f) * 4.0f;
    const float stop = std::min(std::floor(place), 3.0f);
    const auto& low = stops[static_cast<int>(stop)];
    const auto& high = stops[static_cast<int>(stop) + 1];
    Rgb result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = mix(low[k], high[k], place - stop);
    return result;
}

std::array<float, 4> resolve_pixel(const PixelSums& sums, const Display& display, float depth_scale) {
    const float inverse = sums.alpha > 0.0f ? 1.0f / sums.alpha : 0.0f;
    const Rgb solid{sums.red * inverse, sums.green * inverse, sums.blue * inverse};
    const float share = std::clamp(sums.value * inverse, 0.0f, 1.0f);
    Rgb shown = solid;
    float cover = sums.alpha;
    if (display.mode == Mode::Depth) {
        const float z = sums.depth * inverse;
        shown = map_colour(depth_scale * depth_scale / (depth_scale * depth_scale + z * z));
    } else if (display.mode == Mode::Opacity) {
        shown = {sums.alpha, sums.alpha, sums.alpha};
        cover = 1.0f;
    } else if (display.mode >= Mode::LabelWeight) {
        const float grey =
            (solid[0] * 0.299f + solid[1] * 0.587f + solid[2] * 0.114f) * shaders::DimmedBeauty;
        const Rgb map = map_colour(share);
        for (std::size_t k = 0; k < 3; ++k)
            shown[k] = mix(grey, map[k], shaders::MapCoverage * (0.25f + 0.75f * share));
    } else if (tints(display)) {
        const Rgb tint = tint_over(solid, display.tint);
        for (std::size_t k = 0; k < 3; ++k) shown[k] = mix(solid[k], tint[k], share * display.tint_strength);
    }
    if (display.transparent) return {shown[0], shown[1], shown[2], cover};
    for (std::size_t k = 0; k < 3; ++k) shown[k] = shown[k] * cover + display.background[k] * (1.0f - cover);
    return {shown[0], shown[1], shown[2], 1.0f};
}

void resolve(const LightSums& sums, const Display& display, float depth_scale, ThreadPool& pool,
             std::vector<std::uint8_t>& rgba) {
    GSE_CHECK(sums.colour != nullptr && sums.alpha != nullptr);
    GSE_CHECK(!needs_value(display) || sums.value != nullptr);
    GSE_CHECK(!needs_depth(display) || sums.depth != nullptr);
    const auto width = static_cast<std::size_t>(sums.colour->width),
               height = static_cast<std::size_t>(sums.colour->height);
    rgba.resize(width * height * 4);
    const bool plain = display.mode <= Mode::Labels && display.mode != Mode::Depth &&
                       display.mode != Mode::Opacity && !tints(display) && !display.transparent;
    pool.parallel_for(height, RowsAtOnce, [&](std::size_t begin, std::size_t end, unsigned) {
        const std::size_t first = begin * width, count = (end - begin) * width;
        const float *colour = sums.colour->data.data() + first * 3, *alpha = sums.alpha->data.data() + first;
        std::uint8_t* out = rgba.data() + first * 4;
        if (plain) return resolve_plain(colour, alpha, count, display.background, out);
        for (std::size_t i = 0; i < count; ++i) {
            const PixelSums pixel{colour[i * 3],
                                  colour[i * 3 + 1],
                                  colour[i * 3 + 2],
                                  alpha[i],
                                  sums.depth != nullptr ? sums.depth->data[first + i] : 0.0f,
                                  sums.value != nullptr ? sums.value->data[first + i] : 0.0f};
            const auto shown = resolve_pixel(pixel, display, depth_scale);
            for (std::size_t k = 0; k < 4; ++k) out[i * 4 + k] = to_byte(shown[k]);
        }
    });
}

}  // namespace gse::preview
