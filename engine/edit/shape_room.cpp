// A cylinder of cells, and its box.
#include "engine/edit/shape_room.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/edit/region_frame.h"

namespace gse::edit {
namespace {

constexpr int RoomCells = 24;              // along the longest side of the room
constexpr double LeastWidth = 0.4;         // of its height: half the width of a room, for what was tall and thin
constexpr float ShownLogit = -5.5373f;     // opacity 1/255
constexpr double PlaceMargin = 0.3;        // of the longest side of a place (views.md 17)

}  // namespace

namespace {

AddRegion room_of(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up, const Vec3& front, double share, bool by_longest) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const Frame frame = make_frame(up, front);
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        if (bits[row] != 0 && set.opacity_logit()[row] > ShownLogit) points.push_back(frame.to_frame({p[0], p[1], p[2]}));
    }
    if (points.empty()) return {};
    const Box old = trimmed_box(points, BoundsTrim);
    const Vec3 size = old.size(), centre = old.centre();
    const double wide = (1 + share) * std::max({0.5 * size.x, 0.5 * size.z, LeastWidth * size.y});
    if (!(wide > 0) || !(size.y > 0)) return {};
    const double more = share * (by_longest ? std::max({size.x, size.y, size.z}) : size.y);
    const Box room{{centre.x - wide, old.low.y, centre.z - wide}, {centre.x + wide, old.high.y + more, centre.z + wide}};
    auto region = fill(frame, make_grid(room, RoomCells), [&](const Vec3& p) {
        const double dx = p.x - centre.x, dz = p.z - centre.z;
        return dx * dx + dz * dz <= wide * wide;
    });
    region.origin = "room";
    return region;
}

}  // namespace

AddRegion room_around(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up, const Vec3& front, double share) {
    return room_of(set, bits, up, front, share, false);
}

AddRegion room_above(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up, const Vec3& front, double share) {
    return room_of(set, bits, up, front, share, true);
}

HullBox bounds_of(const AddRegion& room, const GaussianData& place) {
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
