// Trimmed bounds of a label and the orbit that frames them.
#include "engine/localize/focus.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/math/quantile.h"

namespace gse::localize {
namespace {

constexpr float InvisibleLogit = -5.5373f;  // opacity 1/255

/// Values of one axis of the visible labelled rows.
std::vector<double> labelled_coordinates(const GaussianSet& set, std::span<const std::uint8_t> bits,
                                         int axis) {
    std::vector<double> values;
    for (std::size_t row = 0; row < set.size(); ++row) {
        const double value = set.position()[row * 3 + static_cast<std::size_t>(axis)];
        if (bits[row] != 0 && set.opacity_logit()[row] > InvisibleLogit && std::isfinite(value))
            values.push_back(value);
    }
    return values;
}

}  // namespace

OrbitParameters focus_orbit(const GaussianSet& set, std::span<const std::uint8_t> bits,
                            const OrbitParameters& base, const FocusParameters& parameters) {
    GSE_CHECK_EQ(bits.size(), set.size());
    Vec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
        auto values = labelled_coordinates(set, bits, axis);
        if (values.empty()) return base;
        low[axis] = nearest_quantile(values, parameters.trim);
        high[axis] = nearest_quantile(values, 1 - parameters.trim);
    }
    const Vec3 size = high - low;
    // The largest half extent stands for the radius: a diagonal would leave thin things small in the picture.
    const double radius = 0.5 * std::max({size.x, size.y, size.z});
    if (!(radius > 0)) return base;
    OrbitParameters result = base;
    result.centre = (low + high) * 0.5 + normalized(base.up) * (2 * radius * parameters.head_room);
    // A region as deep as it is wide reaches towards the camera: measure the fill at its front face.
    result.radius = radius / (std::tan(base.fov_x / 2) * parameters.fill) + 0.5 * radius;
    return result;
}

bool worth_refocusing(const OrbitParameters& base, const OrbitParameters& focused,
                      const FocusParameters& parameters) {
    return focused.radius < parameters.least_change * base.radius;
}

}  // namespace gse::localize
