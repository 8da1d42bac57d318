// Order along a space-filling curve: rows that follow each other are near each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gse {

/// Numbers of the points in Morton order (Z-order, 10 bits per axis of their box); `position` [N,3] in any
/// frame. Points of one cell, and points that are not finite (first), keep their order. O(N log N),
/// deterministic.
std::vector<std::uint32_t> morton_order(std::span<const float> position);

}  // namespace gse
