// Writer of PlayCanvas compressed PLY: Morton order, bounds per 256 splats, quantised values.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <numbers>

#include "engine/base/log.h"
#include "engine/io/compressed_ply.h"
#include "engine/io/encoding.h"
#include "engine/io/formats.h"

namespace gse::io {
namespace {

constexpr float ScaleLimit = 20;             // log-scales outside +-20 would ruin the bounds of their chunk
constexpr std::uint32_t MortonCells = 1024;  // per axis

/// Spreads the low 10 bits so that two zero bits follow each.
std::uint32_t spread_bits(std::uint32_t v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}

/// Row numbers in Morton order of their positions, so that the splats of a chunk are neighbours.
std::vector<std::uint32_t> morton_order(const GaussianSpans& set) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < set.position.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], set.position[i]);
        high[i % 3] = std::max(high[i % 3], set.position[i]);
    }
    std::vector<std::uint32_t> codes(set.size), order(set.size);
    for (std::size_t row = 0; row < set.size; ++row) {
        std::uint32_t code = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double extent = static_cast<double>(high[axis]) - low[axis];
            const double unit =
                extent > 0 ? (static_cast<double>(set.position[row * 3 + axis]) - low[axis]) / extent : 0;
            code |= spread_bits(std::min(MortonCells - 1, static_cast<std::uint32_t>(unit * MortonCells)))
                    << axis;
        }
        codes[row] = code;
    }
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
    return order;
}

/// The nine values of a splat that its chunk bounds: position, clamped log-scale, base colour.
using Bounded = std::array<float, 9>;

Bounded bounded_values(const GaussianSpans& set, std::size_t row) {
    Bounded values{};
    const std::size_t sh_stride = (rest_of_degree(set.sh_degree) + 1) * 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        values[axis] = set.position[row * 3 + axis];
        values[3 + axis] = std::clamp(set.log_scale[row * 3 + axis], -ScaleLimit, ScaleLimit);
        values[6 + axis] =
            static_cast<float>(colour_from_sh(static_cast<double>(set.sh[row * sh_stride + axis])));
    }
    return values;
}

struct Bounds {
    Bounded low, high;
    Bounds() {
        low.fill(std::numeric_limits<float>::max());
        high.fill(std::numeric_limits<float>::lowest());
    }
    void add(const Bounded& values) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i] = std::min(low[i], values[i]);
            high[i] = std::max(high[i], values[i]);
        }
    }
    /// Position of the value between the bounds in steps of 1 / (2^bits - 1).
    std::uint32_t code(std::size_t index, float value, unsigned bits) const {
        const double extent = static_cast<double>(high[index]) - low[index];
        const double unit = extent > 0 ? (static_cast<double>(value) - low[index]) / extent : 0;
        const auto steps = static_cast<double>((1u << bits) - 1);
        return static_cast<std::uint32_t>(std::clamp(unit, 0.0, 1.0) * steps + 0.5);
    }
};

std::uint32_t pack_rotation(const float* wxyz) {
    std::array<double, 4> q = unit_quaternion(wxyz);
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
    const double sign = q[largest] < 0 ? -1 : 1;
    auto word = static_cast<std::uint32_t>(largest);
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const double unit = std::clamp(sign * q[i] / std::numbers::sqrt2 + 0.5, 0.0, 1.0);
        word = (word << 10) | static_cast<std::uint32_t>(unit * 1023 + 0.5);
    }
    return word;
}

std::uint32_t pack_11_10_11(const Bounds& bounds, const Bounded& values, std::size_t first) {
    return (bounds.code(first, values[first], 11) << 21) |
           (bounds.code(first + 1, values[first + 1], 10) << 11) |
           bounds.code(first + 2, values[first + 2], 11);
}

std::uint32_t pack_colour(const Bounds& bounds, const Bounded& values, double opacity) {
    std::uint32_t word = 0;
    for (std::size_t i = 6; i < 9; ++i) word = (word << 8) | bounds.code(i, values[i], 8);
    return (word << 8) | to_byte(opacity * 255);
}

std::uint8_t pack_sh(float value) {
    return static_cast<std::uint8_t>(std::clamp((static_cast<double>(value) / 8 + 0.5) * 256, 0.0, 255.0));
}

std::string header_text(std::size_t count, int sh_degree) {
    std::string text = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Generated by GSEditPro\nelement chunk {}\n",
        (count + CompressedChunkRows - 1) / CompressedChunkRows);
    for (const char* name :
         {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y", "min_scale_z",
          "max_scale_x", "max_scale_y", "max_scale_z", "min_r", "min_g", "min_b", "max_r", "max_g", "max_b"})
        text += fmt::format("property float {}\n", name);
    text += fmt::format("element vertex {}\n", count);
    for (const char* name : {"packed_position", "packed_rotation", "packed_scale", "packed_color"})
        text += fmt::format("property uint {}\n", name);
    if (sh_degree > 0) {
        text += fmt::format("element sh {}\n", count);
        for (std::size_t i = 0; i < rest_of_degree(sh_degree) * 3; ++i)
            text += fmt::format("property uchar f_rest_{}\n", i);
    }
    return text + "end_header\n";
}

void append_sh(std::string& out, const GaussianSpans& set, std::size_t row) {
    const std::size_t rest = rest_of_degree(set.sh_degree);
    const float* sh = set.sh.data() + row * (rest + 1) * 3 + 3;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 0; k < rest; ++k) append_value(out, pack_sh(sh[k * 3 + channel]));
}

}  // namespace

std::string write_compressed_ply(const Scene& scene, std::vector<std::uint32_t>* order_out) {
    const GaussianSet storable = storable_rows(scene.gaussians, "compressed PLY");
    const GaussianSpans set = storable.spans();
    const std::vector<std::uint32_t> order = morton_order(set);
    std::string out = header_text(set.size, set.sh_degree);
    std::string vertices, sh;
    for (std::size_t begin = 0; begin < order.size(); begin += CompressedChunkRows) {
        const std::size_t end = std::min(order.size(), begin + CompressedChunkRows);
        Bounds bounds;
        std::array<Bounded, CompressedChunkRows> values;
        for (std::size_t i = begin; i < end; ++i)
            bounds.add(values[i - begin] = bounded_values(set, order[i]));
        for (std::size_t group = 0; group < 9; group += 3) {
            for (std::size_t i = 0; i < 3; ++i) append_value(out, bounds.low[group + i]);
            for (std::size_t i = 0; i < 3; ++i) append_value(out, bounds.high[group + i]);
        }
        for (std::size_t i = begin; i < end; ++i) {
            const Bounded& row = values[i - begin];
            append_value(vertices, pack_11_10_11(bounds, row, 0));
            append_value(vertices, pack_rotation(set.rotation.data() + order[i] * 4));
            append_value(vertices, pack_11_10_11(bounds, row, 3));
            append_value(vertices, pack_colour(bounds, row, opacity_from_logit(set.opacity_logit[order[i]])));
            append_sh(sh, set, order[i]);
        }
    }
    if (order_out != nullptr) *order_out = order;
    return out + vertices + sh;
}

}  // namespace gse::io
