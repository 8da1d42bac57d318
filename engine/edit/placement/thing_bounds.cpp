// Ground by the lowest layer of a scene's rows; the rest is the thing.
#include "engine/edit/placement/thing_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/edit/placement/ground_rows.h"
#include "engine/scene/framing.h"
#include "engine/scene/layout/surroundings.h"
#include "engine/scene/scene.h"

namespace gse::edit {
namespace {

constexpr std::size_t MostLookedAt = 200'000;  // of a scene that are looked at
constexpr double LeastGroundShare = 0.05;      // of the rows: fewer are the underside of a thing
constexpr double LeastThingShare = 0.02;       // of the rows: fewer are blades of the grass

std::size_t rows_in(const std::vector<std::uint8_t>& bits) {
    return static_cast<std::size_t>(std::count(bits.begin(), bits.end(), std::uint8_t{1}));
}

/// The set, or evenly chosen rows of a large one.
GaussianSet some_rows(const GaussianSet& set) {
    const std::size_t step = set.size() / MostLookedAt + 1;
    if (step == 1) return set;
    std::vector<unsigned char> keep(set.size(), 0);
    for (std::size_t row = 0; row < keep.size(); row += step) keep[row] = 1;
    return set.filtered(keep);
}

/// Adds the ground under a thing to its rows: what it stands on, or its own underside.
void add_footprint(const GaussianSet& set, const std::vector<std::uint8_t>& ground, const Bounds& thing,
                   const Vec3& up, std::vector<std::uint8_t>& rows) {
    constexpr double Upright = 0.9;  // component of `up` along the axis that is not looked at
    for (std::size_t row = 0; row < rows.size(); ++row) {
        bool under = ground[row] != 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double at = set.position()[row * 3 + static_cast<std::size_t>(axis)];
            under =
                under && (std::abs(up[axis]) > Upright || (at >= thing.low[axis] && at <= thing.high[axis]));
        }
        if (under) rows[row] = 1;
    }
}

}  // namespace

Bounds thing_bounds(const GaussianSet& whole_set, const Vec3& up) {
    const GaussianSet set = some_rows(whole_set);
    const Bounds whole = framing_bounds(set);
    const auto around = surrounding_rows(set);
    std::vector<std::uint8_t> rows = usable_rows(set);
    for (std::size_t row = 0; row < around.size(); ++row)
        if (around[row] != 0) rows[row] = 0;
    const auto all = static_cast<double>(rows_in(rows));
    const auto ground = lowest_layer(set, rows, up);
    const auto low = static_cast<double>(rows_in(ground));
    if (low < LeastGroundShare * all || all - low < LeastThingShare * all) return whole;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (ground[row] != 0) rows[row] = 0;
    add_footprint(set, ground, framing_bounds(set, rows), up, rows);
    const Bounds thing = framing_bounds(set, rows);
    return thing.radius() > 0 && thing.radius() < whole.radius() ? thing : whole;
}

}  // namespace gse::edit
