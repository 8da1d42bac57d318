// Rows near the ground's height, by the nearest colours of ground and thing.
#include "engine/edit/placement/ground_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/edit/placement/upright_bounds.h"

namespace gse::edit {
namespace {

using RowColour = std::array<float, 3>;

constexpr double Thickness = 0.04;  // of the thing's height, up and down: the ground's rows
constexpr double Around = 1.5;      // of the thing's half width: ground so far out is compared with
constexpr double MostLow = 0.5;     // of the label: more of it is a ground itself, or as flat as one
constexpr double Nearer = 0.5;      // distance to the ground's colour, over that to the thing's
// Difference of coefficients (0.03 of a channel) below which a row has a colour of the object.
constexpr double Apart = 0.1;
constexpr std::size_t LeastGround = 20;  // rows that make a ground
// Number of them beyond the thing's half width, in each of four quarters: a ground reaches out on all sides.
constexpr std::size_t LeastBeside = 5;
constexpr std::size_t MostColours = 600;  // of each that a row is compared with

/// Evenly chosen ones of many.
void thin_out(std::vector<RowColour>& colours) {
    if (colours.size() <= MostColours) return;
    for (std::size_t i = 0; i < MostColours; ++i) colours[i] = colours[i * colours.size() / MostColours];
    colours.resize(MostColours);
}

float nearest(const std::vector<RowColour>& colours, const RowColour& to) {
    float least = std::numeric_limits<float>::infinity();
    for (const auto& colour : colours) {
        float squared = 0;
        for (std::size_t c = 0; c < 3; ++c) squared += (colour[c] - to[c]) * (colour[c] - to[c]);
        least = std::min(least, squared);
    }
    return std::sqrt(least);
}

}  // namespace

std::vector<std::size_t> ground_rows(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                     const Vec3& up, const Vec3& front) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const auto standing = standing_of(set, bits, up, front);
    if (!standing.found()) return {};
    const Frame frame = make_frame(up, front);
    const Vec3 foot = frame.to_frame(standing.foot);
    const double thickness = Thickness * standing.height, reach = 0.5 * Around * standing.width();
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(set.sh_degree())) * 3;
    const auto colour = [&](std::size_t row) {
        const auto sh = set.sh().subspan(row * stride, 3);
        return RowColour{sh[0], sh[1], sh[2]};
    };
    std::vector<RowColour> ground, thing;
    std::vector<std::size_t> low;
    std::array<std::size_t, 4> beside{};
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto at = set.position().subspan(row * 3, 3);
        const Vec3 p = frame.to_frame({at[0], at[1], at[2]});
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        const bool is_low = std::abs(p.y - foot.y) <= thickness;
        if (bits[row] == 0) {
            const double distance = std::hypot(p.x - foot.x, p.z - foot.z);
            if (!is_low || distance > reach) continue;
            ground.push_back(colour(row));
            if (distance > reach / Around) ++beside[(p.x > foot.x ? 1u : 0u) + (p.z > foot.z ? 2u : 0u)];
        } else if (is_low) {
            low.push_back(row);
        } else if (p.y > foot.y) {
            thing.push_back(colour(row));
        }
    }
    if (ground.size() < LeastGround || *std::min_element(beside.begin(), beside.end()) < LeastBeside)
        return {};
    if (static_cast<double>(low.size()) > MostLow * static_cast<double>(low.size() + thing.size())) return {};
    thin_out(ground);
    thin_out(thing);
    std::erase_if(low, [&](std::size_t row) {
        const double own = nearest(thing, colour(row));
        return !(own >= Apart && nearest(ground, colour(row)) <= Nearer * own);
    });
    return low;
}

namespace {

constexpr int Cells = 24;            // along the side of a grid over what is labelled
constexpr double Layer = 0.05;       // of its width
constexpr double LowestShare = 0.1;  // of a cell's rows, up to which they may be floaters below the ground

/// Heights by cells.
class LowMap {
public:
    LowMap(const std::vector<Vec3>& points, const Box& box)
        : box_(box), lows_(Count, std::numeric_limits<double>::infinity()) {
        std::vector<std::vector<double>> heights(Count);
        for (const auto& point : points)
            heights[index(across(point.x, 0), across(point.z, 2))].push_back(point.y);
        for (std::size_t i = 0; i < Count; ++i)
            if (!heights[i].empty()) lows_[i] = quantile(std::move(heights[i]), LowestShare);
    }
    /// The lowest of the cell and of those around it: where a thing hides the ground, that beside it tells.
    double around(const Vec3& point) const {
        const int u = across(point.x, 0), v = across(point.z, 2);
        double low = std::numeric_limits<double>::infinity();
        for (int dv = -1; dv <= 1; ++dv)
            for (int du = -1; du <= 1; ++du)
                if (u + du >= 0 && u + du < Cells && v + dv >= 0 && v + dv < Cells)
                    low = std::min(low, lows_[index(u + du, v + dv)]);
        return low;
    }

private:
    static constexpr std::size_t Count = static_cast<std::size_t>(Cells) * Cells;
    static std::size_t index(int u, int v) { return static_cast<std::size_t>(v * Cells + u); }
    int across(double value, int axis) const {
        return std::clamp(
            static_cast<int>(Cells * (value - box_.low[axis]) / std::max(box_.size()[axis], 1e-12)), 0,
            Cells - 1);
    }

    Box box_;
    std::vector<double> lows_;
};

}  // namespace

std::vector<std::uint8_t> lowest_layer(const GaussianSet& set, const std::vector<std::uint8_t>& bits,
                                       const Vec3& up) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const Frame frame = make_frame(up, {});
    std::vector<std::size_t> rows;
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        if (bits[row] == 0) continue;
        const auto at = set.position().subspan(row * 3, 3);
        const Vec3 p = frame.to_frame({at[0], at[1], at[2]});
        if (std::isfinite(p.x + p.y + p.z)) rows.push_back(row), points.push_back(p);
    }
    if (points.empty()) return bits;
    const Box box = trimmed_box(points, BoundsTrim);
    const double width = std::max(box.size().x, box.size().z);
    if (width <= box.size().y) return bits;
    const LowMap lows(points, box);
    std::vector<std::uint8_t> ground(bits.size(), 0);
    for (std::size_t i = 0; i < rows.size(); ++i)
        ground[rows[i]] = points[i].y <= lows.around(points[i]) + Layer * width ? 1 : 0;
    return ground;
}

}  // namespace gse::edit
