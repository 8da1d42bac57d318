// Free places for a thing: beside, on or under another, and for copies of it.
#pragma once

#include <span>
#include <vector>

#include "engine/edit/placement/region_frame.h"

namespace gse::edit {

/// Search for places of one thing, in frame coordinates. A place is where the foot goes.
class FreePlace {
public:
    /// `box` and `foot` of the thing; `others`: visible points of everything else, which stay alive.
    FreePlace(const Box& box, const Vec3& foot, std::span<const Vec3> others)
        : box_(box), foot_(foot), others_(others) {}

    /// Place next to a box in a horizontal direction (1 along x or z), as far out as it takes to be free.
    /// `level`: height of the foot, and the middle of the box.
    Vec3 next_to(const Box& anchor, const Vec3& direction, const Vec3& level) const;
    /// Place to the right or to the left of a box, where less is in the way.
    Vec3 beside(const Box& anchor, const Vec3& level) const;
    /// Place on top of another thing: near its middle, or on a ground near the present place. `points` of
    /// that thing tell the height of its surface; without any it is the top of its box.
    Vec3 upon(const Box& anchor, std::span<const Vec3> points) const;
    /// Free height between `level` and the lower side of another thing, at its middle. Infinite where its
    /// points do not tell.
    double clearance_below(const Box& anchor, std::span<const Vec3> points, double level) const;
    /// Height of the ground near a place; its own height where there is none.
    double ground_below(const Vec3& place) const;

private:
    Vec3 foot_at(double x, double y, double z) const;
    std::size_t in_the_way(const Vec3& place) const;

    Box box_;
    Vec3 foot_;
    std::span<const Vec3> others_;
};

/// Offsets of `count` copies from a thing with this box: to its right and left, then in rows behind and
/// before it, with a gap. A copy that nothing carries at that height stands on what lies below. Places that
/// others take come last.
std::vector<Vec3> places_of_copies(const Box& box, int count, std::span<const Vec3> others);

}  // namespace gse::edit
