// Mean and deviation in CIELAB (Reinhard et al. 2001).
#include "engine/remote/views/colour_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/edit/request/scales.h"
#include "engine/edit/words/colour_word.h"
#include "engine/localize/clusters.h"

namespace gse::remote {
namespace {

using Lab = std::array<double, 3>;

constexpr std::size_t LeastRing = 64;  // pixels: fewer say nothing about tones
constexpr double EvenDeviation = 1;    // CIELAB units: a ring of one colour says nothing about contrast
constexpr double MostGain = 1.2;       // of a deviation; more is no shift of tones
constexpr double MostToneShift = 20;   // CIELAB units; more is no shift of tones either

struct Tones {
    Lab mean{}, deviation{};
};

Lab lab_at(const Image& picture, std::size_t pixel) {
    return edit::lab_of({picture.data[pixel * 3], picture.data[pixel * 3 + 1], picture.data[pixel * 3 + 2]});
}

Tones tones_of(const Image& picture, const std::vector<std::size_t>& pixels) {
    Tones tones;
    Lab squares{};
    for (const auto pixel : pixels) {
        const auto lab = lab_at(picture, pixel);
        for (std::size_t c = 0; c < 3; ++c) tones.mean[c] += lab[c], squares[c] += lab[c] * lab[c];
    }
    const auto count = static_cast<double>(pixels.size());
    for (std::size_t c = 0; c < 3; ++c) {
        tones.mean[c] /= count;
        tones.deviation[c] = std::sqrt(std::max(0.0, squares[c] / count - tones.mean[c] * tones.mean[c]));
    }
    return tones;
}

double display_value(double linear) {
    linear = std::clamp(linear, 0.0, 1.0);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// sRGB in [0,1] of CIE 1976 L*a*b* under D65.
std::array<float, 3> srgb_of(const Lab& lab) {
    const double fy = (lab[0] + 16) / 116, fx = fy + lab[1] / 500, fz = fy - lab[2] / 200;
    const auto inverse = [](double f) {
        return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29);
    };
    const double x = 0.95047 * inverse(fx), y = inverse(fy), z = 1.08883 * inverse(fz);
    return {static_cast<float>(display_value(3.2404542 * x - 1.5371385 * y - 0.4985314 * z)),
            static_cast<float>(display_value(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z)),
            static_cast<float>(display_value(0.0556434 * x - 0.2040259 * y + 1.0572252 * z))};
}

/// Pixels of the ring around the mask.
std::vector<std::size_t> ring_around(const Mask& mask) {
    const auto grown = localize::dilate(mask, MatchRing * mask.width / edit::ReferenceSide);
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (grown.data[i] != 0 && mask.data[i] == 0) pixels.push_back(i);
    return pixels;
}

}  // namespace

Image match_colours(const Image& drawn, const Image& sent, const Mask& mask) {
    GSE_CHECK_EQ(drawn.data.size(), sent.data.size());
    const auto ring = ring_around(mask);
    if (ring.size() < LeastRing) return drawn;
    const auto now = tones_of(drawn, ring), wanted = tones_of(sent, ring);
    Lab gain{1, 1, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        if (std::abs(wanted.mean[c] - now.mean[c]) > MostToneShift) return drawn;
        if (now.deviation[c] > EvenDeviation && wanted.deviation[c] > EvenDeviation)
            gain[c] = std::clamp(wanted.deviation[c] / now.deviation[c], 1 / MostGain, MostGain);
    }
    Image result = drawn;
    for (std::size_t i = 0; i < result.pixel_count(); ++i) {
        auto lab = lab_at(drawn, i);
        for (std::size_t c = 0; c < 3; ++c) lab[c] = gain[c] * (lab[c] - now.mean[c]) + wanted.mean[c];
        const auto colour = srgb_of(lab);
        std::copy(colour.begin(), colour.end(), result.data.begin() + static_cast<std::ptrdiff_t>(i * 3));
    }
    return result;
}

}  // namespace gse::remote
