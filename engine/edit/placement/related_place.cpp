// Room on a side of the source, and a round thing in it.
#include "engine/edit/placement/related_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
constexpr double MostGap = 0.5;       // of a thing's height, between it and the ground: less is contact
constexpr double MostGapOn = 0.15;    // of a thing's height, between it and a seat or a table
constexpr double MostWider = 2;       // than what suits the source, where the views put something
constexpr std::size_t FewPoints = 3;  // specks below the source are no ground
constexpr double GroundShare = 0.9;   // of the points below the source that lie below the ground's surface

constexpr int MostTopCells = 32;        // of a thing seen from above, along its longer side
constexpr int FewestTopCells = 8;       // with few points
constexpr double PointsOfCell = 4;      // of a thing, for as many cells as there are in a square
constexpr std::size_t KnownAround = 5;  // of a cell's eight neighbours, for a cell without points
constexpr double TopShare = 0.8;        // of a cell's points that lie below its surface
constexpr double Level = 0.02;          // of the longest side: heights of one level place, up and down
constexpr int LevelSteps = 100;         // heights that are tried
constexpr double LeastDisc = 0.25;      // of the shorter side: radius of a place that carries something
constexpr double DiscMargin = 1.1;      // of that radius: how far out the views may vote
constexpr double UprightShare = 2.2;    // of that radius: how tall what is put there may be
constexpr double FillsDisc = 0.6;       // of that radius: radius of what is put there unasked

/// Heights of a thing's surface seen from above, on a grid of square cells. NaN where nothing lies.
class TopView {
public:
    explicit TopView(const std::vector<Vec3>& points) : box_(trimmed_box(points, BoundsTrim)) {
        const Vec3 size = box_.size();
        const auto cells = static_cast<int>(std::sqrt(static_cast<double>(points.size()) / PointsOfCell));
        side_ = std::max({size.x, size.z, 1e-9}) / std::clamp(cells, FewestTopCells, MostTopCells);
        level_ = Level * std::max({size.x, size.y, size.z});
        columns_ = static_cast<int>(size.x / side_) + 1, rows_ = static_cast<int>(size.z / side_) + 1;
        std::vector<std::vector<double>> heights(static_cast<std::size_t>(columns_ * rows_));
        for (const Vec3& p : points)
            if (box_.has(p)) heights[cell_at(p)].push_back(p.y);
        for (auto& cell : heights)
            surface_.push_back(cell.empty() ? std::nan("") : quantile(std::move(cell), TopShare));
        fill_gaps();
    }

    double shorter_side() const { return std::min(box_.size().x, box_.size().z); }

    /// The widest disc of cells within Level of one height.
    RestingPlace widest() const {
        RestingPlace best;
        for (int step = 0; step <= LevelSteps; ++step) {
            const RestingPlace place = widest_at(box_.low.y + box_.size().y * step / LevelSteps);
            if (place.radius > best.radius) best = place;
        }
        best.centre.y = height_within(best);
        return best;
    }

private:
    /// Gives cells without points the median height of their neighbours.
    void fill_gaps() {
        const auto measured = surface_;
        for (int z = 1; z + 1 < rows_; ++z)
            for (int x = 1; x + 1 < columns_; ++x) {
                const auto cell = static_cast<std::size_t>(z * columns_ + x);
                if (!std::isnan(measured[cell])) continue;
                std::vector<double> around;
                for (const int dz : {-1, 0, 1})
                    for (const int dx : {-1, 0, 1})
                        if (const double height =
                                measured[static_cast<std::size_t>((z + dz) * columns_ + x + dx)];
                            !std::isnan(height))
                            around.push_back(height);
                if (around.size() >= KnownAround) surface_[cell] = quantile(std::move(around), 0.5);
            }
    }

    /// Median height of the cells of a level disc.
    double height_within(const RestingPlace& place) const {
        std::vector<double> heights;
        for (int z = 0; z < rows_; ++z)
            for (int x = 0; x < columns_; ++x) {
                const Vec3 middle = centre_of(x, z, place.centre.y);
                if (level_at(x, z, place.centre.y) && length(middle - place.centre) <= place.radius)
                    heights.push_back(surface_[static_cast<std::size_t>(z * columns_ + x)]);
            }
        return heights.empty() ? place.centre.y : quantile(std::move(heights), 0.5);
    }

    Vec3 centre_of(int x, int z, double height) const {
        return {box_.low.x + (x + 0.5) * side_, height, box_.low.z + (z + 0.5) * side_};
    }

    std::size_t cell_at(const Vec3& p) const {
        const int x = std::min(static_cast<int>((p.x - box_.low.x) / side_), columns_ - 1);
        const int z = std::min(static_cast<int>((p.z - box_.low.z) / side_), rows_ - 1);
        return static_cast<std::size_t>(z * columns_ + x);
    }

    bool level_at(int x, int z, double height) const {
        if (x < 0 || z < 0 || x >= columns_ || z >= rows_) return false;
        const double surface = surface_[static_cast<std::size_t>(z * columns_ + x)];
        return std::abs(surface - height) <= level_;
    }

    RestingPlace widest_at(double height) const {
        std::vector<std::array<int, 2>> level, rim;
        for (int z = -1; z <= rows_; ++z)
            for (int x = -1; x <= columns_; ++x) {
                if (level_at(x, z, height)) level.push_back({x, z});
                else if (level_at(x - 1, z, height) || level_at(x + 1, z, height) ||
                         level_at(x, z - 1, height) || level_at(x, z + 1, height))
                    rim.push_back({x, z});
            }
        RestingPlace best;
        for (const auto& [x, z] : level) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const auto& [rim_x, rim_z] : rim)
                nearest = std::min(nearest, std::hypot(x - rim_x, z - rim_z));
            const double radius = (nearest - 0.5) * side_;
            if (radius > best.radius) best = {centre_of(x, z, height), radius};
        }
        return best;
    }

    Box box_;
    double side_ = 0, level_ = 0;
    int columns_ = 0, rows_ = 0;
    std::vector<double> surface_;
};

}  // namespace

std::optional<RestingPlace> resting_place(const std::vector<Vec3>& points) {
    if (points.empty()) return std::nullopt;
    const TopView top(points);
    const RestingPlace place = top.widest();
    if (place.radius < LeastDisc * top.shorter_side()) return std::nullopt;
    return place;
}

RelatedPlace::RelatedPlace(language::Relation relation, const std::vector<Vec3>& source,
                           const std::vector<Vec3>& others)
    : relation_(relation), source_(trimmed_box(source, BoundsTrim)) {
    if (relation == language::Relation::Above) {
        find_room_above(source);
        return;
    }
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

void RelatedPlace::find_room_above(const std::vector<Vec3>& source) {
    top_ = resting_place(source);
    found_ = top_.has_value();
    if (!found_) return;
    radius_ = FillsDisc * top_->radius;
    const double reach = DiscMargin * top_->radius;
    box_.low = top_->centre - Vec3{reach, 0, reach};
    box_.high = top_->centre + Vec3{reach, UprightShare * top_->radius, reach};
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

bool RelatedPlace::suits(const VoxelRegion& region, const Frame& frame) const {
    if (relation_ == language::Relation::Under || region.empty()) return !region.empty();
    std::vector<Vec3> points;
    for (const Vec3& centre : region.centres) points.push_back(frame.to_frame(centre));
    const Box box = trimmed_box(points, 0);
    const Vec3 size = box.size(), usual = thing().size();
    const double surface = top_ ? top_->centre.y : source_.low.y, gap = top_ ? MostGapOn : MostGap;
    return box.low.y - surface <= gap * (size.y + region.side) &&
           std::max(size.x, size.z) <= MostWider * std::max(usual.x, usual.z);
}

Box RelatedPlace::thing() const {
    const Vec3 middle = source_.centre(), half = source_.size() * 0.5;
    const double gap = Gap / Radius * radius_;
    Vec3 centre{middle.x, source_.low.y + radius_, middle.z}, size{radius_, radius_, radius_};
    switch (relation_) {
        case language::Relation::Above: centre = top_->centre + Vec3{0, radius_, 0}; break;
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
    region.origin = relation_ == language::Relation::Above ? "on" : language::place_name(relation_);
    return region;
}

}  // namespace gse::edit
