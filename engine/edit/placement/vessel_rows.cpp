// Outline of horizontal slices about one upright axis: circles below, none above.
#include "engine/edit/placement/vessel_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"

namespace gse::edit {
namespace vessel {
namespace {

constexpr int Slices = 48;                // over the label's height
constexpr int MostBelow = 32;             // slices below the label that may belong to the vessel
constexpr std::size_t Sectors = 32;       // of a turn
constexpr float SolidLogit = -0.85f;      // of the opacity (0.3) from which a row counts
constexpr double Trim = 0.005;            // of the labelled rows, off at either end of an axis
constexpr double Around = 0.35;           // of the label's width: what stands so far out counts too
constexpr std::size_t LeastInSector = 2;  // rows that tell how far a sector reaches
constexpr double Outermost = 0.9;         // rank of that distance among the sector's rows
constexpr double LeastSectors = 0.3;      // of all: fewer tell no circle
constexpr double SameRadius = 0.1;        // of a radius: distances of one circle differ by no more
constexpr double Turning = 0.55;      // share of the sectors in one circle: between a wall's and a plant's
constexpr double LeastWall = 0.7;     // mean share over a vessel's slices
constexpr double MostPlant = 0.56;    // mean share over the slices above
constexpr int LeastSlices = 4;        // of a vessel, that tell a circle
constexpr double LeastHeight = 0.08;  // of the label's height: of a vessel
constexpr double LeastAbove = 0.12;   // of the labelled rows lie above a vessel
constexpr double MostSlender = 4;     // height of a vessel over its diameter: a trunk has more
constexpr double LeastRadius = 0.3;   // of the reach of the plant above (a trunk has less)
constexpr double Reach = 0.8;         // rank of that reach among the rows above
constexpr double Seam = 1.12;         // of the wall's radius: rows of a vessel beyond it
constexpr double Filled = 0.3;        // of its height, below the rim: what lies inside may be seen
constexpr double ClosedWall = 0.8;    // of the sectors have rows, on average over those slices
constexpr double Inside = 0.8;        // of the wall's radius: rows nearer to the axis lie inside
constexpr double OtherRadius = 1.6;   // of the median radius: no slice of one vessel has more, or less by it
constexpr int Widening = 2;           // slices to either side whose wall counts too
constexpr int FitRounds = 5;
constexpr double FitShare = 0.7;      // of the points that a round keeps
constexpr double WideCircle = 3;      // of a slice's reach: a circle of no smaller radius is a straight line
constexpr double OutlineFrom = 0.85;  // of a sector's reach: rows from there on lie in the outline

/// Point of the horizontal plane.
struct Point {
    double x = 0, z = 0;
};

double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.z - b.z); }

struct Circle {
    Point centre;
    double radius = 0;
};

using Slice = std::vector<Point>;
using Reaches = std::array<double, Sectors>;  // 0 = too few rows in that sector

std::size_t sector_of(const Point& at, const Point& centre) {
    const double turn = std::atan2(at.z - centre.z, at.x - centre.x) / (2 * std::numbers::pi) + 0.5;
    return std::min(static_cast<std::size_t>(turn * Sectors), Sectors - 1);
}

/// Distance from the centre to what lies outermost, per sector.
Reaches reaches_of(const Slice& slice, const Point& centre) {
    std::array<std::vector<double>, Sectors> distances;
    for (const auto& at : slice) distances[sector_of(at, centre)].push_back(distance(at, centre));
    Reaches reaches{};
    for (std::size_t sector = 0; sector < Sectors; ++sector)
        if (distances[sector].size() >= LeastInSector)
            reaches[sector] = quantile(std::move(distances[sector]), Outermost);
    return reaches;
}

/// Circle of the least squared error in x^2 + z^2 = 2 cx x + 2 cz z + c (Kasa); none for points on a line.
std::optional<Circle> fitted_circle(const Slice& points) {
    Point mean;
    for (const auto& p : points) mean.x += p.x, mean.z += p.z;
    const auto count = static_cast<double>(points.size());
    mean.x /= count, mean.z /= count;
    double xx = 0, xz = 0, zz = 0, xr = 0, zr = 0, rr = 0;
    for (const auto& p : points) {
        const double x = p.x - mean.x, z = p.z - mean.z, square = x * x + z * z;
        xx += x * x, xz += x * z, zz += z * z;
        xr += x * square, zr += z * square, rr += square;
    }
    const double determinant = xx * zz - xz * xz;
    if (!(determinant > 1e-12 * (xx + zz) * (xx + zz))) return std::nullopt;
    const double x = 0.5 * (xr * zz - zr * xz) / determinant, z = 0.5 * (zr * xx - xr * xz) / determinant;
    return Circle{{mean.x + x, mean.z + z}, std::sqrt(x * x + z * z + rr / count)};
}

/// Circle through most of the points; each round leaves out those that lie farthest from it.
std::optional<Circle> robust_circle(const Slice& points) {
    Slice kept = points;
    std::optional<Circle> circle;
    for (int round = 0; round < FitRounds; ++round) {
        if (kept.size() < LeastInSector * 4) return std::nullopt;
        circle = fitted_circle(kept);
        if (!circle) return std::nullopt;
        const auto off = [&](const Point& p) {
            return std::abs(distance(p, circle->centre) - circle->radius);
        };
        std::vector<double> errors;
        for (const auto& p : points) errors.push_back(off(p));
        const double most = quantile(std::move(errors), FitShare);
        kept.clear();
        for (const auto& p : points)
            if (off(p) <= most) kept.push_back(p);
    }
    return circle;
}

Point median_of(const Slice& slice) {
    std::vector<double> x, z;
    for (const auto& p : slice) x.push_back(p.x), z.push_back(p.z);
    return {quantile(std::move(x), 0.5), quantile(std::move(z), 0.5)};
}

/// Centre of the circle that a slice's outline lies in; none where there is no such circle.
std::optional<Point> centre_of(const Slice& slice) {
    if (slice.size() < LeastInSector * 4) return std::nullopt;
    const Point middle = median_of(slice);
    const auto reaches = reaches_of(slice, middle);
    Slice outline;
    std::vector<double> distances;
    for (const auto& at : slice) {
        const double from = distance(at, middle), reach = reaches[sector_of(at, middle)];
        distances.push_back(from);
        if (reach > 0 && from >= OutlineFrom * reach) outline.push_back(at);
    }
    const auto circle = robust_circle(outline);
    if (!circle || circle->radius > WideCircle * quantile(std::move(distances), 1 - Trim))
        return std::nullopt;
    return circle->centre;
}

/// The circle about the axis that most sectors of a slice reach to.
struct Ring {
    double share = 0;  // of the sectors with rows: those in the circle
    double wall = 0;   // share, or 0 where the radius is not that of the vessel's wall
    double radius = 0;
    double sectors = 0;  // share of all that have rows
    bool known = false;  // enough of them
};

Ring ring_of(const Slice& slice, const Point& centre) {
    std::vector<double> reaches;
    for (const double reach : reaches_of(slice, centre))
        if (reach > 0) reaches.push_back(reach);
    Ring ring;
    ring.sectors = static_cast<double>(reaches.size()) / Sectors;
    ring.known = ring.sectors >= LeastSectors;
    if (!ring.known) return ring;
    for (const double radius : reaches) {
        double sum = 0, count = 0;
        for (const double other : reaches)
            if (std::abs(other - radius) < SameRadius * radius) sum += other, count += 1;
        if (count / static_cast<double>(reaches.size()) <= ring.share) continue;
        ring.share = count / static_cast<double>(reaches.size()), ring.radius = sum / count;
    }
    ring.wall = ring.share;
    return ring;
}

/// Run of slices [first, last] that are rings about one axis.
struct Vessel {
    Point axis;
    std::vector<Ring> rings;  // of all slices
    int first = 0, last = -1;
    double weight = 0;  // sum over the run of what their shares have beyond Turning
};

/// Radii of the run's rings.
std::vector<double> radii_of(const Vessel& vessel) {
    std::vector<double> radii;
    for (int i = vessel.first; i <= vessel.last; ++i)
        if (const auto& ring = vessel.rings[static_cast<std::size_t>(i)]; ring.known)
            radii.push_back(ring.radius);
    return radii;
}

/// Takes the run of the greatest weight.
void take_heaviest_run(Vessel& vessel) {
    double sum = 0;
    int from = 0;
    vessel.first = 0, vessel.last = -1, vessel.weight = 0;
    for (int i = 0; i < static_cast<int>(vessel.rings.size()); ++i) {
        const auto& ring = vessel.rings[static_cast<std::size_t>(i)];
        if (!ring.known) continue;
        if (sum <= 0) sum = 0, from = i;
        sum += ring.wall - Turning;
        if (sum > vessel.weight) vessel.weight = sum, vessel.first = from, vessel.last = i;
    }
}

/// The heaviest run about an axis. A ring of quite another radius than most of its run is no wall of it.
Vessel vessel_about(const std::vector<Slice>& slices, const Point& axis) {
    Vessel vessel{axis, {}};
    for (const auto& slice : slices) vessel.rings.push_back(ring_of(slice, axis));
    take_heaviest_run(vessel);
    if (vessel.last < 0) return vessel;
    const double median = quantile(radii_of(vessel), 0.5);
    for (auto& ring : vessel.rings)
        if (ring.radius > OtherRadius * median || ring.radius * OtherRadius < median) ring.wall = 0;
    take_heaviest_run(vessel);
    return vessel;
}

/// Solid rows of the scene at the label's place, in slices from below the label to its top.
class Column {
public:
    Column(const std::vector<Vec3>& solid, const std::vector<Vec3>& labelled) {
        std::vector<double> heights;
        for (const auto& p : labelled) heights.push_back(p.y);
        const double foot = quantile(heights, Trim);
        step_ = (quantile(std::move(heights), 1 - Trim) - foot) / Slices;
        low_ = foot - MostBelow * step_;
        if (!(step_ > 0)) return;
        const Box box = trimmed_box(labelled, Trim);
        const Vec3 pad = box.size() * Around;
        slices_.resize(static_cast<std::size_t>(Slices + MostBelow));
        for (const auto& p : solid) {
            const int slice = slice_at(p.y);
            if (slice < 0 || slice >= Slices + MostBelow || p.x < box.low.x - pad.x ||
                p.x > box.high.x + pad.x || p.z < box.low.z - pad.z || p.z > box.high.z + pad.z)
                continue;
            slices_[static_cast<std::size_t>(slice)].push_back({p.x, p.z});
        }
    }
    const std::vector<Slice>& slices() const { return slices_; }
    double step() const { return step_; }
    /// Slice at a height; -1 below all of them, their number above.
    int slice_at(double height) const {
        const double slice = std::floor((height - low_) / step_);
        return static_cast<int>(std::clamp(slice, -1.0, static_cast<double>(Slices + MostBelow)));
    }

private:
    double low_ = 0, step_ = 0;
    std::vector<Slice> slices_;
};

double mean_share(const Vessel& vessel, int from, int to) {
    double sum = 0, count = 0;
    for (int i = from; i < to; ++i)
        if (const auto& ring = vessel.rings[static_cast<std::size_t>(i)]; ring.known)
            sum += ring.share, count += 1;
    return count > 0 ? sum / count : 0;
}

/// True where the run is a vessel by its proportions, and something else grows out of it.
bool holds_plant(const Vessel& vessel, const Column& column, const std::vector<Vec3>& labelled) {
    const auto radii = radii_of(vessel);
    if (static_cast<int>(radii.size()) < LeastSlices) return false;
    const int height = vessel.last - vessel.first + 1;
    const double radius = quantile(radii, 0.5);
    if (height < LeastHeight * Slices || height * column.step() > MostSlender * 2 * radius) return false;
    std::vector<double> above;
    for (const auto& p : labelled)
        if (column.slice_at(p.y) > vessel.last) above.push_back(distance({p.x, p.z}, vessel.axis));
    if (static_cast<double>(above.size()) < LeastAbove * static_cast<double>(labelled.size())) return false;
    if (radius < LeastRadius * quantile(std::move(above), Reach)) return false;
    return mean_share(vessel, vessel.first, vessel.last + 1) >= LeastWall &&
           mean_share(vessel, vessel.last + 1, Slices + MostBelow) <= MostPlant;
}

std::optional<Vessel> find_vessel(const Column& column, const std::vector<Vec3>& labelled) {
    std::optional<Vessel> best;
    for (const auto& slice : column.slices()) {
        const auto axis = centre_of(slice);
        if (!axis) continue;
        auto vessel = vessel_about(column.slices(), *axis);
        if (vessel.last < 0 || (best && vessel.weight <= best->weight)) continue;
        best = std::move(vessel);
    }
    if (!best || !holds_plant(*best, column, labelled)) return std::nullopt;
    return best;
}

/// Radius of the wall per slice; a slice without a ring has one on a line between its neighbours'.
std::vector<double> wall_radii(const Vessel& vessel) {
    std::vector<double> radii(vessel.rings.size(), 0);
    int last = -1;
    for (int i = vessel.first; i <= vessel.last; ++i) {
        const auto& ring = vessel.rings[static_cast<std::size_t>(i)];
        if (ring.wall < Turning) continue;
        const double before = last < 0 ? ring.radius : radii[static_cast<std::size_t>(last)];
        for (int between = last < 0 ? vessel.first : last + 1; between <= i; ++between)
            radii[static_cast<std::size_t>(between)] = std::lerp(
                before, ring.radius, static_cast<double>(between - last) / static_cast<double>(i - last));
        last = i;
    }
    for (int i = last + 1; last >= 0 && i <= vessel.last; ++i)
        radii[static_cast<std::size_t>(i)] = radii[static_cast<std::size_t>(last)];
    return radii;
}

/// The least and the largest radius in a slice and the slices next to it: a wall that leans covers both.
struct Wall {
    double least = 0, largest = 0;
};

std::vector<Wall> walls_of(const Vessel& vessel) {
    const auto radii = wall_radii(vessel);
    std::vector<Wall> walls(radii.size());
    for (int i = vessel.first; i <= vessel.last; ++i) {
        const auto first = radii.begin() + std::max(vessel.first, i - Widening);
        const auto last = radii.begin() + std::min(vessel.last, i + Widening) + 1;
        walls[static_cast<std::size_t>(i)] = {*std::min_element(first, last), *std::max_element(first, last)};
    }
    return walls;
}

/// First slice in which rows inside the wall are the vessel's filling. Beyond the last slice where walls are
/// open to a side, as in a scan from one side.
int filled_from(const Vessel& vessel) {
    const int from = vessel.last + 1 - static_cast<int>(Filled * (vessel.last + 1 - vessel.first));
    double sectors = 0;
    for (int i = from; i <= vessel.last; ++i) sectors += vessel.rings[static_cast<std::size_t>(i)].sectors;
    return sectors >= ClosedWall * (vessel.last + 1 - from) ? from : vessel.last + 1;
}

}  // namespace
}  // namespace vessel

VesselRows vessel_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Vec3& up,
                       const Vec3& front) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const Frame frame = make_frame(up, front);
    std::vector<Vec3> places, solid, labelled;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto at = set.position().subspan(row * 3, 3);
        const auto& p = places.emplace_back(frame.to_frame({at[0], at[1], at[2]}));
        if (!std::isfinite(p.x + p.y + p.z) || !(set.opacity_logit()[row] > vessel::SolidLogit)) continue;
        solid.push_back(p);
        if (bits[row] != 0) labelled.push_back(p);
    }
    if (labelled.empty()) return {};
    const vessel::Column column(solid, labelled);
    const auto found = vessel::find_vessel(column, labelled);
    if (!found) return {};
    const auto walls = vessel::walls_of(*found);
    const int filled_from = vessel::filled_from(*found);
    VesselRows rows{std::vector<std::uint8_t>(bits.size(), 0), std::vector<std::uint8_t>(bits.size(), 0)};
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const Vec3& p = places[row];
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        const int slice = column.slice_at(p.y);
        if (slice < found->first || slice > found->last) continue;
        const auto& wall = walls[static_cast<std::size_t>(slice)];
        const double from = vessel::distance({p.x, p.z}, found->axis);
        if (from > vessel::Seam * wall.largest) continue;
        (slice >= filled_from && from < vessel::Inside * wall.least ? rows.filling : rows.vessel)[row] = 1;
    }
    return rows;
}

}  // namespace gse::edit
