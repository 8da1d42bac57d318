// A grid of columns over the host: the height of its ground in each, and what stands on it.
#include "engine/scene/transform/merge_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/math/quantile.h"
#include "engine/scene/layout/surroundings.h"

namespace gse {
namespace {

constexpr float FaintLogit = -5.5373f;  // opacity 1/255
constexpr double GuestShare = 1.0 / 3;  // of the host's size: that of a guest whose own size does not suit
constexpr double MostOff = 4;           // times larger or smaller than that: its own size does not suit
constexpr double RobustTrim = 0.02;     // of the rows at either end: floaters
constexpr double GuestTrim = 0.005;     // of a guest's: few of its rows float, and its foot counts
constexpr int MostColumns = 48;         // along the longer side of the host
constexpr double RowsPerColumn = 16;    // that a square host would have: few rows make wide columns
constexpr std::size_t LeastRows = 4;    // in a column that has a ground
constexpr double LowShare = 0.1;        // of the rows of a column below its ground: floaters
constexpr double GroundShare = 0.25;    // of the columns have a ground that is lower than the host's
constexpr double GroundBand = 0.06;     // of the host's size: slopes and steps of one ground
constexpr double Footing = 0.6;         // of the columns below the guest that must be ground
constexpr double LeastRise = 0.1;       // of the guest's height: what is lower is not in its way
constexpr double FreeShare = 0.03;      // of the rows over as large a floor on average: floaters
constexpr double BesideGap = 0.1;       // of the guest's width, to a host without a ground

using Points = std::vector<Vec3>;

/// Rows that are seen and are no haze or sky, y up.
Points upright_points(const GaussianSet& set, const Affine& upright) {
    const auto around = surrounding_rows(set);
    Points points;
    for (std::size_t row = 0; row < set.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        const bool finite = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
        if (finite && set.opacity_logit()[row] > FaintLogit && (around.empty() || around[row] == 0))
            points.push_back(upright({p[0], p[1], p[2]}));
    }
    return points;
}

struct UprightBox {
    Vec3 low, high;
    Vec3 size() const { return high - low; }
    Vec3 middle() const { return (low + high) * 0.5; }
    double longest() const { return std::max({size().x, size().y, size().z}); }
};

UprightBox robust_box(const Points& points, double trim) {
    UprightBox box;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Vec3& p : points) values.push_back(p[axis]);
        box.low[axis] = nearest_quantile(values, trim);
        box.high[axis] = nearest_quantile(values, 1 - trim);
    }
    return box;
}

/// Columns of a host.
class Floor {
public:
    Floor(const Points& points, const UprightBox& box) : points_(points), box_(box) {
        const double wanted = std::sqrt(static_cast<double>(points.size()) / RowsPerColumn);
        const int columns = std::clamp(static_cast<int>(wanted), 1, MostColumns);
        side_ = std::max({box.size().x, box.size().z, 1e-12}) / columns;
        count_x_ = static_cast<int>(std::ceil(box.size().x / side_)) + 1;
        count_z_ = static_cast<int>(std::ceil(box.size().z / side_)) + 1;
        std::vector<std::vector<double>> heights(static_cast<std::size_t>(count_x_ * count_z_));
        for (const Vec3& p : points)
            if (const int cell = cell_of(p.x, p.z); cell >= 0)
                heights[static_cast<std::size_t>(cell)].push_back(p.y);
        std::vector<double> all;
        for (auto& column : heights) {
            const bool has = column.size() >= LeastRows;
            low_.push_back(has ? nearest_quantile(column, LowShare) : std::nan(""));
            if (has) all.push_back(low_.back());
        }
        ground_ = all.empty() ? box.low.y : nearest_quantile(all, GroundShare);
    }

    double ground() const { return ground_; }

    /// Height of the ground under a footprint; nothing where too little of it is ground.
    std::optional<double> ground_below(const Vec3& at, const Vec3& size) const {
        std::vector<double> heights;
        std::size_t cells = 0;
        const double band = GroundBand * box_.longest();
        const double step = std::max({side_, size.x / MostColumns, size.z / MostColumns});
        for (double x = at.x - size.x / 2 + step / 2; x <= at.x + size.x / 2; x += step)
            for (double z = at.z - size.z / 2 + step / 2; z <= at.z + size.z / 2; z += step) {
                ++cells;
                const int cell = cell_of(x, z);
                const double low = cell < 0 ? std::nan("") : low_[static_cast<std::size_t>(cell)];
                if (std::abs(low - ground_) <= band) heights.push_back(low);
            }
        if (cells == 0 || static_cast<double>(heights.size()) < Footing * static_cast<double>(cells))
            return std::nullopt;
        return nearest_quantile(heights, 0.5);
    }

    /// Rows where the guest would stand.
    std::size_t in_the_way(const Vec3& at, const Vec3& size) const {
        return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(), [&](const Vec3& p) {
            return std::abs(p.x - at.x) <= size.x / 2 && std::abs(p.z - at.z) <= size.z / 2 &&
                   p.y >= at.y + LeastRise * size.y && p.y <= at.y + size.y;
        }));
    }

private:
    int cell_of(double x, double z) const {
        const int i = static_cast<int>(std::floor((x - box_.low.x) / side_)),
                  k = static_cast<int>(std::floor((z - box_.low.z) / side_));
        return i < 0 || k < 0 || i >= count_x_ || k >= count_z_ ? -1 : i * count_z_ + k;
    }

    const Points& points_;
    UprightBox box_;
    double side_ = 1, ground_ = 0;
    int count_x_ = 0, count_z_ = 0;
    std::vector<double> low_;  // of each column; NaN where it has too few rows
};

/// Foot of a guest of that size: the free place on the ground that is nearest to the middle.
Vec3 chosen_foot(const Points& host, const UprightBox& box, const Vec3& size, std::string& where) {
    const Floor floor(host, box);
    const Vec3 middle = box.middle();
    constexpr int Steps = 12;  // to every side of the middle
    std::vector<Vec3> places;
    for (int i = -Steps; i <= Steps; ++i)
        for (int k = -Steps; k <= Steps; ++k)
            places.push_back(
                {middle.x + 0.5 * box.size().x * i / Steps, 0, middle.z + 0.5 * box.size().z * k / Steps});
    const auto far = [&](const Vec3& p) { return std::hypot(p.x - middle.x, p.z - middle.z); };
    std::stable_sort(places.begin(), places.end(),
                     [&](const Vec3& a, const Vec3& b) { return far(a) < far(b); });
    const double share = std::min(1.0, size.x * size.z / std::max(box.size().x * box.size().z, 1e-300));
    const auto free = static_cast<std::size_t>(FreeShare * share * static_cast<double>(host.size()));
    std::optional<Vec3> best;
    std::size_t least = 0;
    for (Vec3 place : places) {
        const auto ground = floor.ground_below(place, size);
        if (!ground) continue;
        place.y = *ground;
        const std::size_t blocked = floor.in_the_way(place, size);
        if (!best || blocked < least) best = place, least = blocked;
        if (blocked <= free) break;
    }
    if (best) {
        where = "it stands on the ground near the middle";
        return *best;
    }
    where = "it stands beside the scene, which has no ground for it";
    const UprightBox whole = robust_box(host, GuestTrim);  // its foot may have few rows
    return {whole.high.x + size.x / 2 + BesideGap * std::max(size.x, size.z), whole.low.y, middle.z};
}

/// Directions of a scene with y up, about the origin.
Affine upright(const SceneInfo& info) { return Affine::turn_towards(info.up, {0, 1, 0}, {}); }

Points required_points(const Scene& scene, const Affine& map, const char* which) {
    Points points = upright_points(scene.gaussians, map);
    if (points.empty())
        throw Error(ErrorCode::InvalidArgument, fmt::format("nothing of the {} scene can be seen", which),
                    "choose another scene");
    return points;
}

}  // namespace

namespace {

/// Foot and factor, with what was chosen.
struct Chosen {
    Vec3 foot;
    double factor = 1;
    std::vector<std::string> notes;
};

std::string size_note(double factor, const char* as) {
    return fmt::format("its size is multiplied by {:.3g}, so that it {}", factor, as);
}

/// In front of what a view shows; nothing where it shows nothing. `upright`: of the host.
std::optional<Chosen> before_what_is_seen(const MergeWishes& wishes, const Affine& upright, const Vec3& size,
                                          double factor) {
    if (!wishes.seen || wishes.seen->empty() || !(size.x + size.y + size.z > 0)) return std::nullopt;
    SeenSurface seen = *wishes.seen;
    seen.camera.rotation = seen.camera.rotation * upright.linear.transposed();
    const SeenPlace place = seen_place(seen, size * factor, wishes.scale.has_value());
    Chosen chosen{place.foot, factor * place.factor, {}};
    if (!place.suits)
        chosen.notes.push_back(size_note(chosen.factor, "can be seen and has room where it is put"));
    chosen.notes.emplace_back(place.stands ? "it stands near the middle of the view"
                                           : "it hangs in front of the middle of the view, which shows "
                                             "nothing that it could stand on");
    return chosen;
}

/// At a place that is given, else on the ground of the host, or beside it.
Chosen in_the_scene(const Points& host, const std::optional<Vec3>& at, const Vec3& size, double factor,
                    bool fixed) {
    const UprightBox box = robust_box(host, RobustTrim);
    const double suits = GuestShare * box.longest(), longest = std::max({size.x, size.y, size.z});
    Chosen chosen{{}, factor, {}};
    if (!fixed && longest > 0 && suits > 0 && (longest > MostOff * suits || longest < suits / MostOff)) {
        chosen.factor = suits / longest;
        chosen.notes.push_back(size_note(chosen.factor, "is a third as large as the scene"));
    }
    if (at) chosen.foot = *at;
    else chosen.foot = chosen_foot(host, box, size * chosen.factor, chosen.notes.emplace_back());
    return chosen;
}

}  // namespace

MergePlace merge_place(const Scene& host, const Scene& guest, const MergeWishes& wishes) {
    const Affine host_upright = upright(host.info), guest_upright = upright(guest.info);
    const Points of_host = required_points(host, host_upright, "first");
    const Affine turned =
        Affine::turn_about({0, 1, 0}, wishes.turn * std::numbers::pi / 180, {}) * guest_upright;
    const UprightBox own = robust_box(required_points(guest, turned, "second"), GuestTrim);
    const double factor = wishes.scale.value_or(1);
    std::optional<Chosen> seen;
    std::optional<Vec3> at;
    if (wishes.at) at = host_upright(*wishes.at);
    else seen = before_what_is_seen(wishes, host_upright, own.size(), factor);
    const Chosen chosen =
        seen ? *seen : in_the_scene(of_host, at, own.size(), factor, wishes.scale.has_value());
    const Vec3 foot{own.middle().x, own.low.y, own.middle().z};
    return {inverse(host_upright) * Affine::move_by(chosen.foot - foot * chosen.factor) *
                Affine::scale_about(chosen.factor, {}) * turned,
            chosen.notes};
}

}  // namespace gse
