// Horizontal slices of what stands at the label's place, and the highest prism among them.
#include "engine/edit/placement/pedestal_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"

namespace gse::edit {
namespace {

constexpr double LowShare = 0.2;         // of the labelled rows: the lowest ones tell how walls stand
constexpr int TurnStep = 5;              // degrees between directions that walls may have
constexpr int Slices = 60;               // over the label's height
constexpr float SolidLogit = -0.85f;     // of the opacity (0.3) from which a row counts
constexpr double Trim = 0.005;           // of the labelled rows, off at either end of an axis
constexpr double Around = 0.35;          // of the label's width: what stands so far out counts too
constexpr double Clipped = 0.03;         // of the section's width: so near the end of what counts it goes on
constexpr double Seam = 0.1;             // of the section's width: rows of a pedestal beyond its walls
constexpr double SliceTrim = 0.03;       // of a slice's rows, off at either end
constexpr std::size_t LeastInSlice = 8;  // rows that tell a slice's bounds
constexpr int BelowTop = 6;              // slices whose median is a prism's cross-section
constexpr int AboveFrom = 2, AboveTo = 6;  // slices above a top: the object right above it
constexpr double SameSide = 0.035;         // of the width: sides of one prism lie so near each other
constexpr double MostAbove = 0.7;          // area of the object above, over the prism's
constexpr double LeastHeight = 0.12;       // of the label's height: of a prism
constexpr double MostMisses = 0.25;        // of a prism's slices: with other bounds
constexpr double MostBase = 0.3;  // of the height from the foot to the top: a wider base below the prism
constexpr double Rim = 0.6;  // of the half width: rows beyond lie in a wall, also in one of a round column
constexpr int Sectors = 24;  // of a turn
constexpr std::size_t Bands = 3;       // of the heights
constexpr double LeastWall = 0.7;      // of the sectors hold a wall
constexpr double FaceRank = 0.95;      // of the heights around a top's edge: those of its face lie below
constexpr std::size_t LeastFace = 20;  // rows that tell them

/// Bounds in the horizontal plane.
struct Rectangle {
    std::array<double, 2> low{}, high{};
    double width(std::size_t axis) const { return std::max(high[axis] - low[axis], 1e-12); }
    double area() const { return width(0) * width(1); }
    bool has(const Vec3& p, double margin) const {
        const std::array<double, 2> at{p.x, p.z};
        for (std::size_t axis = 0; axis < 2; ++axis)
            if (at[axis] < low[axis] - margin * width(axis) || at[axis] > high[axis] + margin * width(axis))
                return false;
        return true;
    }
};

struct Point {
    Vec3 at;  // frame coordinates
    bool labelled = false;
    double xx = 0, xz = 0, zz = 0;  // horizontal covariance
};

struct Slice {
    std::optional<Rectangle> bounds;  // none = too few rows
};

Vec3 place_of(const GaussianSet& set, std::size_t row, const Frame& frame) {
    const auto at = set.position().subspan(row * 3, 3);
    return frame.to_frame({at[0], at[1], at[2]});
}

Point point_of(const GaussianSet& set, std::size_t row, const Frame& frame, bool labelled) {
    Point point{place_of(set, row, frame), labelled};
    const auto q = set.rotation().subspan(row * 4, 4), s = set.log_scale().subspan(row * 3, 3);
    const Mat3 axes = rotation_matrix(Quat(q[0], q[1], q[2], q[3]));
    for (int k = 0; k < 3; ++k) {
        const Vec3 axis = frame.to_frame({axes(0, k), axes(1, k), axes(2, k)});
        const double variance = std::exp(2.0 * s[static_cast<std::size_t>(k)]);
        point.xx += variance * axis.x * axis.x, point.xz += variance * axis.x * axis.z;
        point.zz += variance * axis.z * axis.z;
    }
    return point;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

Rectangle bounds_of(const std::vector<Vec3>& points, double trim) {
    Rectangle bounds;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        std::vector<double> values;
        values.reserve(points.size());
        for (const auto& p : points) values.push_back(axis == 0 ? p.x : p.z);
        bounds.low[axis] = quantile(values, trim), bounds.high[axis] = quantile(std::move(values), 1 - trim);
    }
    return bounds;
}

/// Slices from the lowest solid row at the label's place up to its top; index 0 begins at the label's foot.
class SlicedColumn {
public:
    explicit SlicedColumn(const std::vector<Point>& points) {
        std::vector<double> heights;
        std::vector<Vec3> labelled;
        for (const auto& point : points)
            if (point.labelled) heights.push_back(point.at.y), labelled.push_back(point.at);
        if (heights.empty()) return;
        foot_ = quantile(heights, Trim);
        step_ = (quantile(std::move(heights), 1 - Trim) - foot_) / Slices;
        if (!(step_ > 0)) return;
        place_ = bounds_of(labelled, Trim);
        for (const auto& point : points)
            if (place_.has(point.at, Around)) points_.push_back(point);
        cut();
    }
    int lowest() const { return lowest_; }
    double height_of(int slice) const { return foot_ + slice * step_; }
    int slice_at(double height) const { return static_cast<int>(std::floor((height - foot_) / step_)); }
    bool empty() const { return slices_.empty(); }
    const Slice& operator[](int slice) const {
        static const Slice Nothing;
        const int at = slice - lowest_;
        return at < 0 || at >= static_cast<int>(slices_.size()) ? Nothing
                                                                : slices_[static_cast<std::size_t>(at)];
    }
    const std::vector<Point>& points() const { return points_; }
    /// True where what a section bounds may go on beyond what counts.
    bool clips(const Rectangle& section) const {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double pad = Around * place_.width(axis), near = Clipped * section.width(axis);
            if (section.low[axis] - (place_.low[axis] - pad) < near ||
                place_.high[axis] + pad - section.high[axis] < near)
                return true;
        }
        return false;
    }

private:
    void cut() {
        std::vector<double> heights;
        for (const auto& point : points_) heights.push_back(point.at.y);
        // Never deeper than the label is high twice over: floaters lie there.
        lowest_ = std::clamp(slice_at(quantile(std::move(heights), Trim)), -2 * Slices, 0);
        std::vector<std::vector<Vec3>> rows(static_cast<std::size_t>(Slices - lowest_));
        slices_.resize(rows.size());
        for (const auto& point : points_) {
            const int slice = slice_at(point.at.y);
            if (slice < lowest_ || slice >= Slices) continue;
            const auto i = static_cast<std::size_t>(slice - lowest_);
            rows[i].push_back(point.at);
        }
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (rows[i].size() >= LeastInSlice) slices_[i].bounds = bounds_of(rows[i], SliceTrim);
    }

    Rectangle place_;
    double foot_ = 0, step_ = 0;
    int lowest_ = 0;
    std::vector<Point> points_;  // at the label's place
    std::vector<Slice> slices_;  // from lowest_ on
};

struct Prism {
    int top = 0, bottom = 0;  // slices
    Rectangle section;
    Rectangle above;  // all that the object takes right above the top
};

/// Median bounds of the slices up to `top`; none where too few have any.
std::optional<Rectangle> section_below(const SlicedColumn& column, int top) {
    std::array<std::vector<double>, 2> low, high;
    for (int slice = top - BelowTop; slice <= top; ++slice)
        if (const auto& bounds = column[slice].bounds)
            for (std::size_t axis = 0; axis < 2; ++axis)
                low[axis].push_back(bounds->low[axis]), high[axis].push_back(bounds->high[axis]);
    if (static_cast<int>(low[0].size()) <= BelowTop / 2) return std::nullopt;
    Rectangle section;
    for (std::size_t axis = 0; axis < 2; ++axis)
        section.low[axis] = median(std::move(low[axis])), section.high[axis] = median(std::move(high[axis]));
    return section;
}

bool is_like(const Rectangle& bounds, const Rectangle& section) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double most = SameSide * section.width(axis);
        if (std::abs(bounds.low[axis] - section.low[axis]) >= most ||
            std::abs(bounds.high[axis] - section.high[axis]) >= most)
            return false;
    }
    return true;
}

/// Union of the bounds right above a top, where the object there is clearly smaller than the section.
std::optional<Rectangle> object_above(const SlicedColumn& column, int top, const Rectangle& section) {
    std::vector<double> areas;
    std::optional<Rectangle> all;
    for (int slice = top + AboveFrom; slice < top + AboveTo; ++slice) {
        const auto& bounds = column[slice].bounds;
        if (!bounds) continue;
        areas.push_back(bounds->area());
        if (!all) all = bounds;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            all->low[axis] = std::min(all->low[axis], bounds->low[axis]);
            all->high[axis] = std::max(all->high[axis], bounds->high[axis]);
        }
    }
    if (static_cast<int>(areas.size()) < (AboveTo - AboveFrom) / 2) return std::nullopt;
    if (median(std::move(areas)) > MostAbove * section.area()) return std::nullopt;
    return all;
}

/// Lowest slice that belongs to the prism below a top; a few in between may have other bounds.
int bottom_of(const SlicedColumn& column, int top, const Rectangle& section) {
    int bottom = top, misses = 0;
    for (int slice = top; slice >= column.lowest(); --slice) {
        const auto& bounds = column[slice].bounds;
        if (!bounds) continue;
        if (is_like(*bounds, section)) bottom = slice;
        else if (++misses > std::max(2.0, MostMisses * (top - slice))) break;
    }
    return bottom;
}

/// True where the prism is what stands below the object, down to the foot of everything there.
bool reaches_down(const SlicedColumn& column, const Prism& prism) {
    return prism.top - prism.bottom >= LeastHeight * Slices &&
           prism.bottom - column.lowest() <= MostBase * (prism.top - column.lowest());
}

/// Marks the directions from the section's centre in which a row of its rim extends, one standard deviation
/// to either side.
void mark_wall(const Point& point, const Rectangle& section, std::array<bool, Sectors>& walled) {
    const std::array<double, 2> at{point.at.x, point.at.z};
    std::array<double, 2> from{};
    double rim = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        from[axis] = at[axis] - 0.5 * (section.low[axis] + section.high[axis]);
        rim = std::max(rim, 2 * std::abs(from[axis]) / section.width(axis));
    }
    if (rim <= Rim) return;
    const double radius = std::hypot(from[0], from[1]), x = -from[1] / radius, z = from[0] / radius;
    const double variance = x * x * point.xx + 2 * x * z * point.xz + z * z * point.zz;
    const double middle = std::atan2(from[1], from[0]) / (2 * std::numbers::pi) * Sectors;
    const double half =
        std::atan(std::sqrt(std::max(variance, 0.0)) / radius) / (2 * std::numbers::pi) * Sectors;
    for (int sector = static_cast<int>(std::floor(middle - half));
         sector <= static_cast<int>(std::floor(middle + half)); ++sector)
        walled[static_cast<std::size_t>((sector % Sectors + Sectors) % Sectors)] = true;
}

/// True where walls stand on all sides at all heights: an apron above four legs is no wall.
bool has_walls(const SlicedColumn& column, const Prism& prism) {
    std::array<std::array<bool, Sectors>, Bands> walled{};
    for (const auto& point : column.points()) {
        const int slice = column.slice_at(point.at.y);
        if (slice < prism.bottom || slice >= prism.top) continue;
        const auto band = static_cast<std::size_t>(slice - prism.bottom) * Bands /
                          static_cast<std::size_t>(prism.top - prism.bottom);
        mark_wall(point, prism.section, walled[band]);
    }
    return std::all_of(walled.begin(), walled.end(), [](const auto& band) {
        return static_cast<double>(std::count(band.begin(), band.end(), true)) >= LeastWall * Sectors;
    });
}

std::optional<Prism> highest_prism(const SlicedColumn& column) {
    for (int top = Slices * 2 / 3; top > column.lowest() + BelowTop / 2; --top) {
        const auto section = section_below(column, top);
        if (!section || column.clips(*section) || !column[top].bounds ||
            !is_like(*column[top].bounds, *section))
            continue;
        const auto above = object_above(column, top, *section);
        if (!above) continue;
        const Prism prism{top, bottom_of(column, top, *section), *section, *above};
        if (reaches_down(column, prism) && has_walls(column, prism)) return prism;
    }
    return std::nullopt;
}

/// Height of the prism's face, from the rows around the object's foot.
double face_height(const SlicedColumn& column, const Prism& prism) {
    std::vector<double> heights;
    for (const auto& point : column.points()) {
        const int slice = column.slice_at(point.at.y);
        if (slice < prism.top - 3 || slice > prism.top + AboveFrom) continue;
        if (prism.section.has(point.at, SameSide) && !prism.above.has(point.at, 0))
            heights.push_back(point.at.y);
    }
    return heights.size() < LeastFace ? column.height_of(prism.top + 1)
                                      : quantile(std::move(heights), FaceRank);
}

/// The frame turned about its up axis so that what is labelled low fits the smallest rectangle: along the
/// walls of a pedestal that stands askew.
Frame along_walls(const Frame& frame, const std::vector<Vec3>& labelled) {
    if (labelled.empty()) return frame;
    std::vector<double> heights;
    for (const auto& p : labelled) heights.push_back(p.y);
    const double low = quantile(std::move(heights), LowShare);
    Frame best = frame;
    double least = std::numeric_limits<double>::infinity();
    for (int degrees = 0; degrees < 90; degrees += TurnStep) {
        const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
        std::vector<Vec3> turned;
        for (const auto& p : labelled)
            if (p.y <= low) turned.push_back({c * p.x + s * p.z, p.y, c * p.z - s * p.x});
        const double area = bounds_of(turned, Trim).area();
        if (area >= least) continue;
        least = area;
        best = {frame.side * c + frame.front * s, frame.up, frame.front * c - frame.side * s};
    }
    return best;
}

}  // namespace

std::vector<std::uint8_t> pedestal_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                        const Vec3& up, const Vec3& front) {
    GSE_CHECK_EQ(bits.size(), set.size());
    Frame frame = make_frame(up, front);
    const auto place = [&](std::size_t row) { return place_of(set, row, frame); };
    std::vector<std::size_t> solid;
    std::vector<Vec3> labelled;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const Vec3 p = place(row);
        if (!std::isfinite(p.x + p.y + p.z) || !(set.opacity_logit()[row] > SolidLogit)) continue;
        solid.push_back(row);
        if (bits[row] != 0) labelled.push_back(p);
    }
    frame = along_walls(frame, labelled);
    std::vector<Point> points;
    for (const auto row : solid) points.push_back(point_of(set, row, frame, bits[row] != 0));
    const SlicedColumn column(points);
    const auto prism = column.empty() ? std::nullopt : highest_prism(column);
    if (!prism) return {};
    const double face = face_height(column, *prism);
    std::vector<std::uint8_t> rows(bits.size(), 0);
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const Vec3 p = place(row);
        rows[row] = p.y < face && prism->section.has(p, Seam) ? 1 : 0;
    }
    return rows;
}

}  // namespace gse::edit
