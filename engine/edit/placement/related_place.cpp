// Room on a side of the source, and a round thing in it.
#include "engine/edit/placement/related_place.h"

#include <algorithm>
#include <cmath>

#include "engine/language/grammar.h"

namespace gse::edit {
namespace {

constexpr double Reach = 0.8;        // how far from the source views may vote, of its longest side
constexpr double Radius = 0.25;      // of a thing that suits it, of its longest side
constexpr double Gap = 0.05;         // between both, of the longest side
constexpr double IntoGround = 0.05;  // of the source's height: votes a little below the foot count
constexpr double MostRise = 1.25;    // of the source's height: how tall what stands beside it may be
constexpr double LeastRoom = 0.15;   // of the source's height: less below it holds nothing
// Share of the source's height, of what lies at its foot where there is no room below.
constexpr double FlatHeight = 0.1;
constexpr double FlatWidth = 1.3;     // of the source's own
constexpr std::size_t FewPoints = 3;  // specks below the source are no ground
constexpr double GroundShare = 0.9;   // of the points below the source that lie below the ground's surface

}  // namespace

RelatedPlace::RelatedPlace(language::Relation relation, const std::vector<Vec3>& source,
                           const std::vector<Vec3>& others)
    : relation_(relation), source_(trimmed_box(source, BoundsTrim)) {
    const Vec3 size = source_.size();
    const double longest = std::max({size.x, size.y, size.z, 1e-9}), reach = Reach * longest;
    radius_ = Radius * longest;
    box_ = source_;
    box_.low.y -= IntoGround * size.y;
    box_.high.y = source_.low.y + MostRise * size.y;
    const double wide = radius_ + Gap * longest;  // sideways of the direction of the relation
    const bool sideways = relation == language::Relation::Beside || relation == language::Relation::Left ||
                          relation == language::Relation::Right;
    const Vec3 room =
        sideways ? Vec3{reach, 0, wide} : Vec3{wide, 0, relation == language::Relation::Under ? wide : reach};
    box_.low = box_.low - room;
    box_.high = box_.high + room;
    if (relation == language::Relation::Left || relation == language::Relation::Behind) {
        const int axis = sideways ? 0 : 2;
        box_.high[axis] = source_.low[axis];
    } else if (relation == language::Relation::Right || relation == language::Relation::Before) {
        const int axis = sideways ? 0 : 2;
        box_.low[axis] = source_.high[axis];
    }
    find_room_below(others);
    choose_side(others);
    if (relation == language::Relation::Under) {
        const double flat = FlatHeight * size.y;
        box_.low.y = source_.low.y - (below_ > 0 ? std::min(below_, reach) : flat);
        box_.high.y = source_.low.y + (below_ > 0 ? 0 : 0.5 * flat);
    }
}

void RelatedPlace::find_room_below(const std::vector<Vec3>& others) {
    const double foot = source_.low.y, height = source_.size().y;
    std::vector<double> heights;
    for (const auto& p : others)
        if (p.x >= source_.low.x && p.x <= source_.high.x && p.z >= source_.low.z && p.z <= source_.high.z &&
            p.y <= foot + LeastRoom * height)
            heights.push_back(p.y);
    below_ = heights.size() < FewPoints ? 2 * radius_ : foot - quantile(heights, GroundShare);
    if (below_ < LeastRoom * height) below_ = 0;
}

void RelatedPlace::choose_side(const std::vector<Vec3>& others) {
    if (relation_ != language::Relation::Beside) {
        sign_ = relation_ == language::Relation::Left ? -1 : 1;
        return;
    }
    const auto in_the_way = [&](double sign) {
        sign_ = sign;
        Box room = thing();
        room.low.y += LeastRoom * source_.size().y;  // the ground itself is not in the way
        return std::count_if(others.begin(), others.end(), [&](const Vec3& p) { return room.has(p); });
    };
    sign_ = in_the_way(1) <= in_the_way(-1) ? 1 : -1;
}

bool RelatedPlace::allows(const Vec3& p) const {
    switch (relation_) {
        case language::Relation::Beside: return p.x < source_.low.x || p.x > source_.high.x;
        default: return box_.has(p);
    }
}

Box RelatedPlace::thing() const {
    const Vec3 middle = source_.centre(), half = source_.size() * 0.5;
    const double gap = Gap / Radius * radius_;
    Vec3 centre{middle.x, source_.low.y + radius_, middle.z}, size{radius_, radius_, radius_};
    switch (relation_) {
        case language::Relation::Behind: centre.z -= half.z + gap + radius_; break;
        case language::Relation::Before: centre.z += half.z + gap + radius_; break;
        case language::Relation::Under:
            if (below_ > 0) {
                size.y = std::min(radius_, 0.5 * below_);
                centre.y = std::max(source_.low.y - below_ + size.y, source_.low.y - 2 * radius_);
            } else {
                size = {FlatWidth * half.x, 0.5 * FlatHeight * source_.size().y, FlatWidth * half.z};
                centre.y = source_.low.y;
            }
            break;
        default: centre.x += sign_ * (half.x + gap + radius_); break;
    }
    return {centre - size, centre + size};
}

VoxelRegion RelatedPlace::usual(const Frame& frame, int cells) const {
    const Box box = thing();
    const Vec3 centre = box.centre(), half = box.size() * 0.5;
    VoxelRegion region = fill(frame, make_grid(box, cells / 2), [=](const Vec3& p) {
        const Vec3 d = p - centre;
        return std::hypot(d.x / half.x, d.y / half.y, d.z / half.z) <= 1;
    });
    region.origin = language::place_name(relation_);
    return region;
}

}  // namespace gse::edit
