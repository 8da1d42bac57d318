// Candidates by distance; the first that is free is taken.
#include "engine/edit/placement/free_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>

namespace gse::edit {
namespace {

constexpr double ThingGap = 0.05;   // between two things, of the longer side of both
constexpr double CopyGap = 0.15;    // between copies, of their own width
constexpr double LeastRise = 0.15;  // of a thing's height: what is lower is the ground, and not in the way
constexpr double Inset = 0.03;      // of a thing's size at every side: things may touch
constexpr std::size_t SpeckPoints = 5;  // specks are not in the way, and carry nothing
constexpr std::size_t LeastGroundPoints = 20;
constexpr double GroundBand = 0.25;    // of a thing's height, up and down: where its ground is looked for
constexpr double ColumnShare = 0.25;   // of a thing's width: radius of the column over which it rests
constexpr double SurfaceShare = 0.95;  // of the points in a column that lie below the surface
constexpr double FlatShare = 0.25;     // of its width: a thing that is no higher and far wider is a ground
constexpr double WideShare = 1.5;      // of a thing's size: so much wider is a ground on all sides
constexpr int OutwardSteps = 8;        // of a quarter of the thing's size
constexpr double OutwardStep = 0.25;
constexpr int CandidatesPerSide = 6;   // on top of another thing, from its middle
constexpr double SpeckShare = 0.02;    // of the points that carry a thing: floaters
constexpr double CarryingShare = 0.2;  // of the points that carry a thing: so many carry a copy
constexpr double StrayShare = 0.02;    // of the points around that float below their ground
constexpr double Neighbourhood = 4;    // of a thing's longest side
constexpr int CopyRows = 2;            // behind and before the thing
constexpr int FineSteps = 3;           // per copy, where it does not go into the usual places
constexpr int MostColumns = 50;        // of copies, to either side

double longest_side(const Box& box) {
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z});
}

Box moved(const Box& box, const Vec3& by) { return {box.low + by, box.high + by}; }

/// Part of a box that must be free of others.
Box inner(const Box& box) {
    const Vec3 size = box.size();
    const Vec3 inset = size * Inset;
    Box result{box.low + inset, box.high - inset};
    result.low.y = box.low.y + LeastRise * size.y;
    return result;
}

std::size_t count_in(const Box& box, std::span<const Vec3> points) {
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.end(), [&](const Vec3& p) { return box.has(p); }));
}

std::vector<double> heights_in_column(std::span<const Vec3> points, const Vec3& middle, double radius) {
    std::vector<double> heights;
    for (const Vec3& p : points)
        if (std::hypot(p.x - middle.x, p.z - middle.z) <= radius) heights.push_back(p.y);
    return heights;
}

double column_radius(const Box& box) {
    const Vec3 size = box.size();
    return ColumnShare * std::max(size.x, size.z);
}

/// Offsets of a grid with `steps` per copy in either direction: to the right and left first, then behind and
/// before, the nearest rows first.
std::vector<Vec3> lattice(const Box& box, int columns, int steps) {
    const Vec3 size = box.size();
    const double across = size.x * (1 + CopyGap) / steps, along = (size.z + CopyGap * size.x) / steps;
    std::vector<Vec3> offsets;
    for (int row = 0; row <= CopyRows * steps; ++row)
        for (int column = 0; column <= columns * steps; ++column)
            for (const double side : {1.0, -1.0})
                for (const double depth : {-1.0, 1.0}) {
                    if ((row == 0 && depth > 0) || (column == 0 && side < 0)) continue;
                    offsets.push_back({side * column * across, 0, depth * row * along});
                }
    return offsets;
}

/// True when copies at these offsets do not meet each other or the thing itself.
bool apart_from_all(const Vec3& offset, const std::vector<Vec3>& places, const Box& box) {
    const Vec3 size = box.size();
    const auto apart = [&](const Vec3& place) {
        constexpr double Touching = 1 + 0.5 * CopyGap;
        return std::abs(place.x - offset.x) >= Touching * size.x ||
               std::abs(place.z - offset.z) >= size.z + (Touching - 1) * size.x;
    };
    return apart({}) && std::all_of(places.begin(), places.end(), apart);
}

/// Surroundings of a thing that is copied.
class CopySpace {
public:
    CopySpace(const Box& box, std::span<const Vec3> others) : box_(box), others_(others) {
        own_ = ground_quarters({});
        stands_ = is_carried({});
        const int carrying = std::accumulate(own_.begin(), own_.end(), 0);
        specks_ = std::max(SpeckPoints, static_cast<std::size_t>(SpeckShare * carrying));
    }

    bool free(const Vec3& offset) const { return count_in(inner(moved(box_, offset)), others_) <= specks_; }
    /// True where the ground goes on below most of the copy, or the thing itself stands on none.
    bool carried(const Vec3& offset) const { return !stands_ || is_carried(offset); }
    /// The offset lowered to what lies below it, or to the lowest points around where nothing does. As it is
    /// for what stands on nothing.
    Vec3 lowered(const Vec3& offset) const {
        if (!stands_) return offset;
        const Box place = moved(box_, offset);
        auto heights = heights_in_column(others_, place.centre(), column_radius(box_));
        std::erase_if(heights, [&](double height) { return height > place.low.y; });
        std::sort(heights.begin(), heights.end(), std::greater<>());
        double ground = lowest_around();
        for (std::size_t i = 0; i + specks_ < heights.size(); ++i)  // the highest layer that is no specks
            if (heights[i] - heights[i + specks_] <= LeastRise * box_.size().y) {
                ground = heights[i];
                break;
            }
        return {offset.x, std::min(ground - box_.low.y, 0.0), offset.z};
    }

private:
    using Quarters = std::array<int, 4>;

    double lowest_around() const {
        const double radius = Neighbourhood * longest_side(box_);
        return quantile(heights_in_column(others_, box_.centre(), radius), StrayShare);
    }

    /// Points at the height of the foot, below each quarter of the box.
    Quarters ground_quarters(const Vec3& offset) const {
        const Box place = moved(box_, offset);
        const Vec3 middle = place.centre(), size = place.size();
        Quarters quarters{};
        for (const Vec3& p : others_)
            if (std::abs(p.y - place.low.y) <= LeastRise * size.y && std::abs(p.x - middle.x) <= size.x / 2 &&
                std::abs(p.z - middle.z) <= size.z / 2)
                ++quarters[(p.x > middle.x ? 1 : 0) + (p.z > middle.z ? 2 : 0)];
        return quarters;
    }

    /// Most quarters must hold a share of the points that carry the thing itself.
    bool is_carried(const Vec3& offset) const {
        constexpr int LeastPoints = 2, LeastQuarters = 3;
        const double own = std::accumulate(own_.begin(), own_.end(), 0) / 4.0;
        const double least = std::max<double>(LeastPoints, CarryingShare * own);
        const Quarters quarters = ground_quarters(offset);
        return std::count_if(quarters.begin(), quarters.end(), [&](int points) { return points >= least; }) >=
               LeastQuarters;
    }

    Box box_;
    std::span<const Vec3> others_;
    Quarters own_{};
    std::size_t specks_ = SpeckPoints;
    bool stands_ = false;
};

}  // namespace

/// Foot of the thing when the middle of its box stands over (x, z).
Vec3 FreePlace::foot_at(double x, double y, double z) const {
    const Vec3 middle = box_.centre();
    return {foot_.x + x - middle.x, y, foot_.z + z - middle.z};
}

std::size_t FreePlace::in_the_way(const Vec3& place) const {
    return count_in(inner(moved(box_, place - foot_)), others_);
}

Vec3 FreePlace::next_to(const Box& anchor, const Vec3& direction, const Vec3& level) const {
    const double reach = 0.5 * std::abs(dot(direction, anchor.size())) +
                         0.5 * std::abs(dot(direction, box_.size())) +
                         ThingGap * std::max(longest_side(anchor), longest_side(box_));
    const double step = OutwardStep * std::abs(dot(direction, box_.size()));
    const Vec3 middle = anchor.centre();
    Vec3 first{};
    for (int k = 0; k <= OutwardSteps; ++k) {
        const Vec3 at = middle + direction * (reach + k * step);
        const Vec3 place = foot_at(at.x, level.y, at.z);
        if (k == 0) first = place;
        if (in_the_way(place) <= SpeckPoints) return place;
    }
    return first;
}

Vec3 FreePlace::beside(const Box& anchor, const Vec3& level) const {
    const Vec3 right = next_to(anchor, {1, 0, 0}, level), left = next_to(anchor, {-1, 0, 0}, level);
    const std::size_t on_right = in_the_way(right), on_left = in_the_way(left);
    const double middle = anchor.centre().x;
    if (on_right <= SpeckPoints &&
        on_left <= SpeckPoints)  // both are free: the nearer one to the other thing
        return std::abs(right.x - middle) <= std::abs(left.x - middle) + ThingGap * box_.size().x ? right
                                                                                                  : left;
    return on_right <= on_left ? right : left;
}

Vec3 FreePlace::upon(const Box& anchor, std::span<const Vec3> points) const {
    const Vec3 size = anchor.size(), own = box_.size();
    const bool ground = size.y <= FlatShare * std::min(size.x, size.z) && size.x >= WideShare * own.x &&
                        size.z >= WideShare * own.z;
    Vec3 start = ground ? box_.centre() : anchor.centre();
    start = {std::clamp(start.x, anchor.low.x, anchor.high.x), 0,
             std::clamp(start.z, anchor.low.z, anchor.high.z)};
    std::vector<Vec3> candidates;
    for (int i = -CandidatesPerSide; i <= CandidatesPerSide; ++i)
        for (int k = -CandidatesPerSide; k <= CandidatesPerSide; ++k) {
            const double step = ground ? 0.5 * std::max(own.x, own.z) : size.x / (2 * CandidatesPerSide);
            const double deep = ground ? step : size.z / (2 * CandidatesPerSide);
            candidates.push_back({start.x + i * step, 0, start.z + k * deep});
        }
    const auto far = [&](const Vec3& p) { return std::hypot(p.x - start.x, p.z - start.z); };
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](const Vec3& a, const Vec3& b) { return far(a) < far(b); });
    Vec3 first = foot_at(start.x, anchor.high.y, start.z);
    bool found = false;
    for (const Vec3& at : candidates) {
        if (at.x < anchor.low.x || at.x > anchor.high.x || at.z < anchor.low.z || at.z > anchor.high.z)
            continue;
        auto heights = heights_in_column(points, at, column_radius(box_));
        if (!points.empty() && heights.size() < SpeckPoints) continue;
        const double surface = points.empty() ? anchor.high.y : quantile(std::move(heights), SurfaceShare);
        const Vec3 place = foot_at(at.x, surface, at.z);
        if (!found) first = place;
        found = true;
        Box needed = inner(moved(box_, place - foot_));
        if (ground) needed.high.y = std::max(needed.high.y, box_.high.y);  // not below what it stood on
        if (count_in(needed, others_) <= SpeckPoints) return place;
    }
    return first;
}

double FreePlace::clearance_below(const Box& anchor, std::span<const Vec3> points, double level) const {
    auto heights = heights_in_column(points, anchor.centre(), column_radius(box_));
    if (heights.size() < SpeckPoints) return std::numeric_limits<double>::infinity();
    return quantile(std::move(heights), 1 - SurfaceShare) - level;
}

double FreePlace::ground_below(const Vec3& place) const {
    const double reach = GroundBand * box_.size().y;
    auto heights = heights_in_column(others_, place, 2 * column_radius(box_));
    std::erase_if(heights, [&](double height) { return std::abs(height - place.y) > reach; });
    return heights.size() < LeastGroundPoints ? place.y : quantile(std::move(heights), 0.5);
}

std::vector<Vec3> places_of_copies(const Box& box, int count, std::span<const Vec3> others) {
    if (count <= 0) return {};
    const CopySpace space(box, others);
    const auto wanted = static_cast<std::size_t>(count);
    const auto beside = lattice(box, std::min(count + 2, MostColumns), 1);
    const auto between = lattice(box, std::min(count + 2, MostColumns), FineSteps);
    std::vector<Vec3> places;
    const auto take = [&](const std::vector<Vec3>& offsets, const auto& suits) {
        for (const Vec3& offset : offsets)
            if (places.size() < wanted && apart_from_all(offset, places, box) && suits(offset))
                places.push_back(offset);
    };
    const auto good = [&](const Vec3& offset) { return space.carried(offset) && space.free(offset); };
    take(beside, good);
    take(between, good);
    std::vector<Vec3> lower;
    std::transform(beside.begin(), beside.end(), std::back_inserter(lower),
                   [&](const Vec3& offset) { return space.lowered(offset); });
    take(lower, [&](const Vec3& offset) { return space.free(offset); });
    take(beside, [](const Vec3&) { return true; });
    return places;
}

}  // namespace gse::edit
