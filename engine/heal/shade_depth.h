// Depth of a shadow on the rows of a surface, from colours whose own variation is known beyond it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/math/vec.h"

namespace gse::heal {

/// Rows of a surface with those beside them.
struct ShadeRow {
    Vec3 off;          // logarithms of the colour less the surface's own
    double trust = 1;  // weight of the colour
    std::array<std::uint32_t, 12> beside{};
    std::uint32_t count = 0;  // of `beside`
};

/// Darkness of the rows: logarithms of light, 0 = as beyond, negative = darker.
struct ShadeDepth {
    std::vector<double> depth;
    Vec3 tint{1};       // change of each channel for a depth of one; the mean is 1
    double noise = 0;   // standard deviation of the mixture of channels beyond
    double spread = 0;  // root mean square of the depth beyond
};

/// `beyond`: rows that no shadow reaches; `near`: rows where it is deepest. The texture's covariance beyond
/// says which mixture of the channels tells light from paint best. Total variation keeps the shadow's rim.
ShadeDepth shade_depth(const std::vector<ShadeRow>& rows, const std::vector<std::uint32_t>& beyond,
                       const std::vector<std::uint32_t>& near);

}  // namespace gse::heal
