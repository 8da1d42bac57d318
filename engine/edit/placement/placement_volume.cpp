// A cylinder of cells, and its box.
#include "engine/edit/placement/placement_volume.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/edit/placement/upright_bounds.h"

namespace gse::edit {
namespace {

constexpr int RoomCells = 24;        // along the longest side of the room
constexpr double PlaceMargin = 0.3;  // of the longest side of a place (METHOD.md, Visual hull)

/// A cylinder on the ground, world units.
struct Cylinder {
    double radius = 0, height = 0;
};

VoxelRegion cells_of(const Cylinder& room, const UprightBounds& standing, const Vec3& up, const Vec3& front) {
    const Frame frame = make_frame(up, front);
    const Vec3 foot = frame.to_frame(standing.foot);
    const double wide = room.radius;
    const Box box{{foot.x - wide, foot.y, foot.z - wide},
                  {foot.x + wide, foot.y + room.height, foot.z + wide}};
    auto region = fill(frame, make_grid(box, RoomCells), [&](const Vec3& p) {
        const double dx = p.x - foot.x, dz = p.z - foot.z;
        return dx * dx + dz * dz <= wide * wide;
    });
    region.origin = "room";
    return region;
}

}  // namespace

VoxelRegion room_around(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up,
                        const Vec3& front, double share) {
    constexpr double LeastWidth = 0.5;  // of its height: half the width of a room, for what was tall and thin
    const auto old = standing_of(set, bits, up, front);
    if (!old.found()) return {};
    const double half_width = std::max(0.5 * old.width(), LeastWidth * old.height);
    return cells_of({(1 + share) * half_width, (1 + share) * figure_height(old)}, old, up, front);
}

VoxelRegion room_above(const UprightBounds& thing, const Vec3& up, const Vec3& front, double share) {
    constexpr double LeastWidth = 0.4;  // what is worn is about as wide as the thing
    if (!thing.found()) return {};
    const double half_width = std::max(0.5 * thing.width(), LeastWidth * thing.height);
    return cells_of({(1 + share) * half_width, thing.height + share * std::max(thing.width(), thing.height)},
                    thing, up, front);
}

HullBox bounds_of(const VoxelRegion& room, const GaussianData& place) {
    HullBox box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
    const auto hold = [&](const Vec3& point) {
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], point[axis]);
            box.high[axis] = std::max(box.high[axis], point[axis]);
        }
    };
    for (const auto& centre : room.centres) hold(centre);
    double margin = room.side;
    if (room.empty()) {
        if (place.size() == 0) return {};
        for (std::size_t row = 0; row < place.size(); ++row)
            hold({place.position[row * 3], place.position[row * 3 + 1], place.position[row * 3 + 2]});
        const Vec3 size = box.high - box.low;
        margin = PlaceMargin * std::max({size.x, size.y, size.z});
    }
    const Vec3 around{margin, margin, margin};
    return {box.low - around, box.high + around};
}

}  // namespace gse::edit
