// Growth of a cost with a size.
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace gse::bench {

/// Exponent p of cost ~ size^p: the slope of the least-squares line through (log size, log cost). Pairs that
/// are not finite or not above 0 are left out; nothing with fewer than two different sizes.
std::optional<double> growth_exponent(const std::vector<std::array<double, 2>>& size_and_cost);

}  // namespace gse::bench
