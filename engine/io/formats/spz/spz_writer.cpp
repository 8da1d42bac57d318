// Writer of .spz versions 2, 3 (read by common programs) and 4 (the newest). Axes are right, up, back as in
// the format's document.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/formats/spz/spz_format.h"

namespace gse::io {
namespace {

constexpr int WordRotations = 3;    // from this version on a rotation is one word instead of three bytes
constexpr int SeparateStreams = 4;  // from this version on every attribute is compressed by itself
constexpr std::uint32_t HeaderOfStreams = 32;  // bytes before the table, where there are no extensions
constexpr int UsualFractionalBits = 12;        // steps of 1/4096 unit, range +-2048
constexpr double LargestCode = 8388607;        // 2^23 - 1

/// Fractional bits of positions: as many (12 at most) as let every position fit. The reference writer would
/// wrap far ones silently.
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

/// Packs a rotation for versions 1 and 2: x, y, z as bytes of the rotation whose w is not negative.
void append_rotation_bytes(std::string& out, const float* wxyz) {
    const std::array<double, 4> unit = unit_quaternion(wxyz);
    const double sign = unit[0] < 0 ? -1 : 1;
    for (std::size_t i = 1; i < 4; ++i) append_value(out, to_byte((sign * unit[i] + 1) * 127.5));
}

/// One string per attribute, in the order of the file.
using Streams = std::array<std::string, 6>;

Streams pack(const GaussianData& data, int version, int bits) {
    Streams streams;
    auto& [position, alpha, colour, scale, rotation, sh] = streams;
    append_positions(position, data.position, bits);
    const std::size_t stride = data.sh_stride();
    for (const float value : data.log_scale)
        append_value(scale, to_byte((static_cast<double>(value) + 10) * 16));
    for (std::size_t row = 0; row < data.size(); ++row) {
        append_value(alpha, to_byte(255 * opacity_from_logit(static_cast<double>(data.opacity_logit[row]))));
        const float* coefficients = data.sh.data() + row * stride;
        for (std::size_t c = 0; c < 3; ++c)
            append_value(colour,
                         to_byte((static_cast<double>(coefficients[c]) * SpzColourScale + 0.5) * 255));
        const float* quaternion = data.rotation.data() + row * 4;
        if (version >= WordRotations) append_value(rotation, pack_rotation(quaternion));
        else append_rotation_bytes(rotation, quaternion);
        for (std::size_t i = 3; i < stride; ++i)
            append_value(sh, to_byte(static_cast<double>(coefficients[i]) * 128 + 128));
    }
    return streams;
}

/// Joins streams for version 4: the header, a table of both sizes of every stream, the streams. Empty ones
/// have no entry.
std::string join_streams(std::string header, const Streams& streams) {
    append_value(header, HeaderOfStreams);
    header.resize(HeaderOfStreams, '\0');
    std::string frames;
    for (const std::string& stream : streams) {
        if (stream.empty()) continue;
        const std::string frame = compress_zstd(stream);
        append_value(header, static_cast<std::uint64_t>(frame.size()));
        append_value(header, static_cast<std::uint64_t>(stream.size()));
        frames += frame;
    }
    return header + frames;
}

void check_spz_version(int version) {
    if (version < OldestSpzVersion || version > NewestSpzVersion)
        throw Error(ErrorCode::InvalidArgument,
                    "version " + std::to_string(version) + " of .spz cannot be written",
                    "use 3 (most programs read it), 4 (the newest) or 2 (the oldest programs)");
}

}  // namespace

std::string write_spz(const Scene& scene, int version) {
    check_spz_version(version);
    GaussianData data = storable_rows(scene.gaussians, ".spz").to_data();
    flip_axes(data, {1, -1, -1});
    const int bits = fractional_bits(data.position);
    const Streams streams = pack(data, version, bits);
    const auto used = std::count_if(streams.begin(), streams.end(),
                                    [](const std::string& stream) { return !stream.empty(); });
    std::string header;
    append_value(header, SpzMagic);
    append_value(header, static_cast<std::uint32_t>(version));
    append_value(header, static_cast<std::uint32_t>(data.size()));
    append_value(header, static_cast<std::uint8_t>(data.sh_degree));
    append_value(header, static_cast<std::uint8_t>(bits));
    append_value(header, static_cast<std::uint8_t>(scene.info.antialiased ? 1 : 0));
    append_value(header, static_cast<std::uint8_t>(version >= SeparateStreams ? used : 0));
    if (version >= SeparateStreams) return join_streams(std::move(header), streams);
    for (const std::string& stream : streams) header += stream;
    return deflate_gzip(header);
}

}  // namespace gse::io
