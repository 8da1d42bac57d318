// Writer of .spz version 3, the newest that common readers know; axes right, up, back as the format's
// document says.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/log.h"
#include "engine/io/encoding.h"
#include "engine/io/formats.h"
#include "engine/io/inflate.h"
#include "engine/io/spz_format.h"

namespace gse::io {
namespace {

constexpr std::uint32_t Version = 3;
constexpr int UsualFractionalBits = 12;  // steps of 1/4096 unit, range +-2048
constexpr double LargestCode = 8388607;  // 2^23 - 1

/// As many fractional bits (12 at most) as let every position fit; the reference writer would wrap far ones
/// silently.
int fractional_bits(const std::vector<float>& position) {
    double largest = 0;
    for (const float value : position) largest = std::max(largest, std::abs(static_cast<double>(value)));
    int bits = UsualFractionalBits;
    while (bits > 0 && std::ldexp(largest, bits) > LargestCode) --bits;
    if (std::ldexp(largest, bits) > LargestCode)
        log::warning("positions beyond {} are clamped; .spz cannot hold them", LargestCode);
    return bits;
}

void append_positions(std::string& out, const std::vector<float>& position, int bits) {
    for (const float value : position) {
        const double scaled =
            std::clamp(std::ldexp(static_cast<double>(value), bits), -LargestCode, LargestCode);
        const auto code = static_cast<std::int32_t>(std::lround(scaled));
        for (int shift = 0; shift < 24; shift += 8) out += static_cast<char>(code >> shift);
    }
}

std::uint32_t pack_rotation(const float* wxyz) {
    const std::array<double, 4> unit = unit_quaternion(wxyz);
    const std::array<double, 4> xyzw = {unit[1], unit[2], unit[3], unit[0]};
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if (std::abs(xyzw[i]) > std::abs(xyzw[largest])) largest = i;
    auto word = static_cast<std::uint32_t>(largest);
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const bool negative = (xyzw[i] < 0) != (xyzw[largest] < 0);
        const double magnitude = std::min(511.0, std::round(std::abs(xyzw[i]) * std::numbers::sqrt2 * 511));
        word = (word << 10) | (negative ? 512u : 0u) | static_cast<std::uint32_t>(magnitude);
    }
    return word;
}

}  // namespace

std::string write_spz(const Scene& scene) {
    GaussianData data = storable_rows(scene.gaussians, ".spz").to_data();
    flip_axes(data, {1, -1, -1});
    const int bits = fractional_bits(data.position);
    std::string raw;
    append_value(raw, SpzMagic);
    append_value(raw, Version);
    append_value(raw, static_cast<std::uint32_t>(data.size()));
    append_value(raw, static_cast<std::uint8_t>(data.sh_degree));
    append_value(raw, static_cast<std::uint8_t>(bits));
    append_value(raw, static_cast<std::uint8_t>(scene.info.antialiased ? 1 : 0));
    append_value(raw, std::uint8_t{0});
    append_positions(raw, data.position, bits);
    for (const float logit : data.opacity_logit)
        append_value(raw, to_byte(255 * opacity_from_logit(static_cast<double>(logit))));
    const std::size_t stride = data.sh_stride();
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t c = 0; c < 3; ++c)
            append_value(raw,
                         to_byte((static_cast<double>(data.sh[row * stride + c]) * SpzColourScale + 0.5) * 255));
    for (const float value : data.log_scale)
        append_value(raw, to_byte((static_cast<double>(value) + 10) * 16));
    for (std::size_t row = 0; row < data.size(); ++row)
        append_value(raw, pack_rotation(data.rotation.data() + row * 4));
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t i = 3; i < stride; ++i)
            append_value(raw, to_byte(static_cast<double>(data.sh[row * stride + i]) * 128 + 128));
    return deflate_gzip(raw);
}

}  // namespace gse::io
