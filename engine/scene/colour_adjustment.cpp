// Affine maps of colours, on spherical harmonics.
#include "engine/scene/colour_adjustment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/check.h"

namespace gse {
namespace {

constexpr Vec3 Luma{0.213, 0.715, 0.072};  // of red, green, blue (feColorMatrix)
constexpr double Warmest = 0.3;            // of red more and of blue less, at most
constexpr double Middle = 0.5;

Mat3 scaled(double r, double g, double b) { return Mat3::from_rows({r, 0, 0, 0, g, 0, 0, 0, b}); }

/// Grey + share * (colour - grey), as a map.
Mat3 saturation_matrix(double share) {
    const double rest = 1 - share;
    return Mat3::from_rows({Luma.x * rest + share, Luma.y * rest, Luma.z * rest, Luma.x * rest,
                            Luma.y * rest + share, Luma.z * rest, Luma.x * rest, Luma.y * rest,
                            Luma.z * rest + share});
}

Mat3 hue_matrix(double degrees) {
    const double c = std::cos(degrees * std::numbers::pi / 180),
                 s = std::sin(degrees * std::numbers::pi / 180);
    return Mat3::from_rows(
        {0.213 + c * 0.787 - s * 0.213, 0.715 - c * 0.715 - s * 0.715, 0.072 - c * 0.072 + s * 0.928,
         0.213 - c * 0.213 + s * 0.143, 0.715 + c * 0.285 + s * 0.140, 0.072 - c * 0.072 - s * 0.283,
         0.213 - c * 0.213 - s * 0.787, 0.715 - c * 0.715 + s * 0.715, 0.072 + c * 0.928 + s * 0.072});
}

/// Opacity 1 - (1 - opacity)^depth, as a logit.
float denser(float logit, double depth) {
    constexpr double Faint = -30;  // from here on opacity and optical depth are the same number
    const double x = logit;
    if (x < Faint)
        return static_cast<float>(
            std::max(x + std::log(depth), static_cast<double>(std::numeric_limits<float>::lowest())));
    // log(1 - opacity)
    const double log_clear = depth * -(x > 0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x)));
    return static_cast<float>(std::min(std::log(-std::expm1(log_clear)) - log_clear,
                                       static_cast<double>(std::numeric_limits<float>::max())));
}

/// The coefficients of one row, [(d+1)^2,3].
void map_colour(std::span<float> sh, const ColourMap& map) {
    for (std::size_t k = 0; k + 2 < sh.size(); k += 3) {
        Vec3 value{sh[k], sh[k + 1], sh[k + 2]};
        value = k > 0 ? map.linear * value
                      : (map.linear * (Vec3{Middle, Middle, Middle} + value * ShC0) + map.offset -
                         Vec3{Middle, Middle, Middle}) /
                            ShC0;
        for (int c = 0; c < 3; ++c) sh[k + static_cast<std::size_t>(c)] = static_cast<float>(value[c]);
    }
}

}  // namespace

ColourMap colour_map(const ColourAdjustment& adjustment) {
    const double warm = Warmest * adjustment.temperature;
    const Mat3 first =
        scaled(adjustment.contrast, adjustment.contrast, adjustment.contrast) *
        scaled(adjustment.brightness * (1 + warm), adjustment.brightness, adjustment.brightness * (1 - warm));
    const double grey = Middle * (1 - adjustment.contrast);
    const Mat3 second = hue_matrix(adjustment.hue) * saturation_matrix(adjustment.saturation);
    return {second * first, second * Vec3{grey, grey, grey}};
}

GaussianSet adjusted(const GaussianSet& set, std::span<const std::uint8_t> rows,
                     const ColourAdjustment& adjustment) {
    GSE_CHECK_EQ(rows.size(), set.size());
    check_fields(adjustment);
    const bool colours = ColourAdjustment{adjustment.hue, adjustment.saturation, adjustment.brightness,
                                          adjustment.contrast, adjustment.temperature} != ColourAdjustment{};
    const auto map = colour_map(adjustment);
    auto data = set.to_data();
    const std::size_t stride = data.sh_stride();
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const auto sh = std::span(data.sh).subspan(row * stride, stride);
        const bool finite =
            std::isfinite(data.opacity_logit[row]) &&
            std::all_of(sh.begin(), sh.end(), [](float value) { return std::isfinite(value); });
        if (rows[row] == 0 || !finite) continue;
        if (colours) map_colour(sh, map);
        if (adjustment.density != 1)
            data.opacity_logit[row] = denser(data.opacity_logit[row], adjustment.density);
    }
    return GaussianSet(std::move(data));
}

std::string adjustment_text(const ColourAdjustment& adjustment) {
    std::string text;
    const auto standard = fields_to_json(ColourAdjustment{}), values = fields_to_json(adjustment);
    for (const auto& [name, value] : values.items())
        if (value != standard[name])
            text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, value.get<double>());
    return text;
}

}  // namespace gse
