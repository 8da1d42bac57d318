// Morton codes (Morton 1966) by interleaving bits.
#include "engine/scene/morton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace gse {
namespace {

constexpr std::uint32_t MortonCells = 1024;  // per axis

/// Spreads the low 10 bits so that two zero bits follow each.
std::uint32_t spread_bits(std::uint32_t v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const float> position) {
    const std::size_t size = position.size() / 3;
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t i = 0; i < size * 3; ++i) {
        if (!std::isfinite(position[i])) continue;
        low[i % 3] = std::min(low[i % 3], position[i]);
        high[i % 3] = std::max(high[i % 3], position[i]);
    }
    std::vector<std::uint32_t> codes(size), order(size);
    for (std::size_t row = 0; row < size; ++row) {
        std::uint32_t code = 0;
        bool finite = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double value = position[row * 3 + axis],
                         extent = static_cast<double>(high[axis]) - low[axis];
            finite = finite && std::isfinite(value);
            const double unit = finite && extent > 0 ? (value - low[axis]) / extent : 0;
            code |= spread_bits(std::min(MortonCells - 1, static_cast<std::uint32_t>(unit * MortonCells)))
                    << axis;
        }
        codes[row] = finite ? code : 0;
    }
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
    return order;
}

}  // namespace gse
