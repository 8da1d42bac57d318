// Order along a space-filling curve: consecutive rows are near each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gse {

/// Numbers of the points in Morton order (Z-order, 10 bits per axis of their box). `position` is [N,3] in any
/// frame. Points of one cell keep their order, as do points that are not finite, which come first. O(N log
/// N), deterministic.
std::vector<std::uint32_t> morton_order(std::span<const float> position);

}  // namespace gse
