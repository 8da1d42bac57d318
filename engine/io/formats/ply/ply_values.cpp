// Decoding of halves, shares and bytes; the 3D filter; large coordinates.
#include "engine/io/formats/ply/ply_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/io/bytes/activation.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/half.h"
#include "engine/scene/origin/world_offset.h"

namespace gse::io {
namespace {

constexpr double PackedShRange = 8;  // of bytes in compressed PLY files, around zero

/// One column of an array of attributes.
struct ArrayColumn {
    std::vector<float>& values;
    std::size_t stride, index;

    template <class F> void change(F&& f) const {
        for (std::size_t i = index; i < values.size(); i += stride)
            values[i] = static_cast<float>(f(values[i]));
    }
    float largest() const {
        float most = 0;
        for (std::size_t i = index; i < values.size(); i += stride) most = std::max(most, values[i]);
        return most;
    }
    bool any_negative() const {
        for (std::size_t i = index; i < values.size(); i += stride)
            if (values[i] < 0) return true;
        return false;
    }
};

/// Half whose bits are this whole number, signed or not. Fractions, which only texts have, stay.
float half_of_bits(float bits) {
    const bool whole = bits >= -32768 && bits <= 65535 && bits == std::floor(bits);
    return whole ? half_to_float(static_cast<std::uint16_t>(static_cast<std::int32_t>(bits))) : bits;
}

double unsigned_byte(float value) { return value < 0 ? value + 256.0 : static_cast<double>(value); }

double sh_of_byte(float value) {
    const double code = unsigned_byte(value);
    const double unit = code <= 0 ? 0 : code >= 255 ? 1 : (code + 0.5) / 256;
    return (unit - 0.5) * PackedShRange;
}

/// Whole number that stands for all of it, by the largest that the file has.
double full_share(double largest) { return largest <= 255 ? 255 : largest <= 65535 ? 65535 : 4294967295.0; }

void decode_opacity(const ArrayColumn& column, PlyType type, std::vector<std::string>& warnings) {
    if (type == PlyType::Int8) column.change([](float value) { return unsigned_byte(value); });
    else if (column.any_negative()) return;  // logits, rounded
    const double largest = column.largest();
    const double full = largest <= 1 ? 1 : full_share(largest);
    column.change([&](float value) { return logit_from_opacity(static_cast<double>(value) / full); });
    warnings.push_back(fmt::format("the opacities are whole numbers, taken as shares of {}", full));
}

/// Colours between 0 and 1, as red, green and blue hold them, to SH.
void decode_colours(GaussianData& data, bool whole) {
    double largest = 0;
    for (std::size_t c = 0; whole && c < 3; ++c)
        largest = std::max<double>(largest, ArrayColumn{data.sh, data.sh_stride(), c}.largest());
    const float scale = whole ? 1.0f / static_cast<float>(full_share(largest)) : 1.0f;
    for (std::size_t c = 0; c < 3; ++c)
        ArrayColumn{data.sh, data.sh_stride(), c}.change(
            [&](float value) { return sh_from_colour(static_cast<double>(value * scale)); });
}

/// Codings met on the way, to be told once each.
struct Met {
    bool halves = false, bytes = false;
};

void decode_columns(std::vector<float>& values, const std::vector<int>& columns, bool is_sh,
                    const PlyElement& vertex, const PlyLayout& layout, Met& met) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] == Absent) continue;
        const ArrayColumn column{values, columns.size(), i};
        switch (coding_of(vertex, layout, columns[i])) {
            case PlyCoding::Half:
                met.halves = true;
                column.change(half_of_bits);
                break;
            case PlyCoding::ByteColour:
                met.bytes = true;
                if (is_sh && i < 3)
                    column.change([](float value) { return sh_from_colour(unsigned_byte(value) / 255); });
                else column.change(sh_of_byte);
                break;
            case PlyCoding::Value:
            case PlyCoding::Share: break;
        }
    }
}

/// Row of the filter's arithmetic, on sizes and opacity as they are drawn.
void widen(std::span<float> sizes, float& opacity, double filter, ActivatedValues activated) {
    double kept = 1, widened[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto value = static_cast<double>(sizes[axis]);
        const double size = activated.sizes ? value : std::exp(value);
        widened[axis] = std::hypot(size, filter);
        kept *= size / widened[axis];
    }
    if (!std::isfinite(kept)) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
        sizes[axis] = static_cast<float>(activated.sizes ? widened[axis] : std::log(widened[axis]));
    const auto value = static_cast<double>(opacity);
    const double left = (activated.opacities ? value : opacity_from_logit(value)) * kept;
    if (activated.opacities) opacity = static_cast<float>(left);
    else opacity = left > 0 ? static_cast<float>(std::log(left) - std::log1p(-left)) : logit_from_opacity(0);
}

}  // namespace

void decode_values(GaussianData& data, const PlyElement& vertex, const PlyLayout& layout,
                   std::vector<std::string>& warnings) {
    Met met;
    decode_columns(data.position, layout.position, false, vertex, layout, met);
    decode_columns(data.log_scale, layout.log_scale, false, vertex, layout, met);
    decode_columns(data.rotation, layout.rotation, false, vertex, layout, met);
    decode_columns(data.opacity_logit, layout.opacity, false, vertex, layout, met);
    decode_columns(data.sh, layout.sh, true, vertex, layout, met);
    const auto coding = [&](int column) { return coding_of(vertex, layout, column); };
    if (layout.colours) decode_colours(data, coding(layout.sh[0]) == PlyCoding::Share);
    if (coding(layout.opacity[0]) == PlyCoding::Share)
        decode_opacity({data.opacity_logit, 1, 0},
                       vertex.properties[static_cast<std::size_t>(layout.opacity[0])].type, warnings);
    if (met.halves) warnings.push_back("the columns of 16-bit whole numbers hold halves (16-bit floats)");
    if (met.bytes) warnings.push_back("f_dc and f_rest of bytes are taken as 8-bit colours");
}

void fuse_filter(GaussianData& data, std::span<const float> filter) {
    const ActivatedValues activated = looks_activated(spans(data));
    for (std::size_t row = 0; row < filter.size(); ++row)
        if (std::isfinite(filter[row]) && filter[row] != 0)
            widen(std::span(data.log_scale).subspan(row * 3, 3), data.opacity_logit[row],
                  static_cast<double>(filter[row]), activated);
}

NearPositions near_positions(std::span<const double> positions, const std::optional<Vec3>& stated) {
    NearPositions near{stated && suits_offset(positions, *stated) ? *stated : world_offset(positions), {}};
    near.values.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double offset = near.offset[static_cast<int>(i % 3)];
        const auto value = static_cast<float>(positions[i] - offset);
        // The sum as a file holds it, so that writing and reading again changes nothing.
        near.values[i] =
            offset == 0 ? value : static_cast<float>((static_cast<double>(value) + offset) - offset);
    }
    return near;
}

}  // namespace gse::io
