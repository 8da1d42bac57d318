// Candidates are pixels of the view: each is the middle of a footprint, whose box is projected back.
#include "engine/scene/transform/seen_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "engine/math/quantile.h"
#include "engine/math/unproject.h"

namespace gse {
namespace {

constexpr double SeenShare = 1.0 / 3;                   // of the view's height: size of what does not suit
constexpr double LeastSeen = 1.0 / 12, MostSeen = 0.6;  // of the view's height: a thing's own size suits
constexpr std::array<double, 3> Smaller{1, 0.5, 0.25};  // sizes that are tried, the largest first
constexpr int Columns = 72;                             // of candidates across the view
constexpr int FootSteps = 5;                            // points of a footprint to a side
constexpr double FootMargin = 0.1;                      // of the footprint, whose rim nothing must carry
constexpr double CarriedShare = 0.6;                    // of the footprint's points that must be carried
constexpr double LevelBand = 0.1;                       // of the box's longest side: steps of one support
constexpr double NearBands = 4;                         // from a footprint's point to the surface seen there
constexpr double ClearShare = 0.95;                     // of the box's points that must be seen
constexpr double TouchShare = 0.1;                      // of the box's height: what is lower may touch
constexpr double WindowShare = 0.2;                     // of the view: its middle
constexpr double NearShare = 0.05;                      // of the middle's depths that are nearer: floaters
constexpr double HalfDiagonal = 0.87;                   // of a box's longest side: it reaches no farther
constexpr double NearestShare = 0.25;                   // of the middle's depth: nothing hangs nearer

class SeenView {
public:
    explicit SeenView(const SeenSurface& surface) : camera_(surface.camera), depth_(surface.depth) {}

    int width() const { return depth_.width; }
    int height() const { return depth_.height; }
    double depth(int x, int y) const { return depth_.at(x, y, 0); }
    Vec3 point(int x, int y) const { return at_depth(x + 0.5, y + 0.5, depth(x, y)); }
    Vec3 at_depth(double x, double y, double z) const { return unprojected(camera_, x, y, z); }
    /// Share of the view's height that a length takes at a depth.
    double share(double size, double z) const { return size * camera_.fy / (z * height()); }

    /// Point of the surface where a point of the world is seen; nothing outside, and where there is none.
    std::optional<Vec3> surface_at(const Vec3& world) const {
        const auto at = pixel(world);
        if (!at || !(depth(at->x, at->y) > 0)) return std::nullopt;
        return point(at->x, at->y);
    }
    /// True for a point in the picture with nothing in front of it.
    bool sees(const Vec3& world) const {
        const auto at = pixel(world);
        return at && (!(depth(at->x, at->y) > 0) || at->z <= depth(at->x, at->y));
    }
    /// Distance from the middle of the view, squared pixels.
    double off_middle(const Vec3& world) const {
        const auto at = pixel(world);
        if (!at) return std::numeric_limits<double>::infinity();
        const double x = at->x + 0.5 - 0.5 * width(), y = at->y + 0.5 - 0.5 * height();
        return x * x + y * y;
    }

private:
    struct Pixel {
        int x = 0, y = 0;
        double z = 0;
    };
    std::optional<Pixel> pixel(const Vec3& world) const {
        const Vec3 at = camera_.to_camera(world);
        if (!(at.z > 0)) return std::nullopt;
        const double x = camera_.fx * at.x / at.z + camera_.cx, y = camera_.fy * at.y / at.z + camera_.cy;
        if (!(x >= 0 && y >= 0 && x < width() && y < height())) return std::nullopt;
        return Pixel{static_cast<int>(x), static_cast<int>(y), at.z};
    }

    const Camera& camera_;
    const Image& depth_;
};

/// Depths that are seen in a part of the view around its middle, in order.
std::vector<double> depths_around_middle(const SeenView& view, double part) {
    std::vector<double> depths;
    const int half_x = std::max(1, static_cast<int>(view.width() * part / 2)),
              half_y = std::max(1, static_cast<int>(view.height() * part / 2));
    for (int y = std::max(0, view.height() / 2 - half_y);
         y < std::min(view.height(), view.height() / 2 + half_y); ++y)
        for (int x = std::max(0, view.width() / 2 - half_x);
             x < std::min(view.width(), view.width() / 2 + half_x); ++x)
            if (view.depth(x, y) > 0) depths.push_back(view.depth(x, y));
    std::sort(depths.begin(), depths.end());
    return depths;
}

double depth_of_share(const std::vector<double>& depths, double share) {
    return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))];
}

/// Height of the support under a footprint; nothing where too little carries it.
std::optional<double> support_height(const SeenView& view, const Vec3& foot, const Vec3& size) {
    const double band = LevelBand * std::max({size.x, size.y, size.z});
    std::vector<double> heights;
    for (int i = 0; i < FootSteps; ++i)
        for (int k = 0; k < FootSteps; ++k) {
            const double across = (1 - 2 * FootMargin) / (FootSteps - 1);
            const Vec3 at = foot + Vec3{size.x * (across * i + FootMargin - 0.5), 0,
                                        size.z * (across * k + FootMargin - 0.5)};
            const auto seen = view.surface_at(at);
            if (seen && std::abs(seen->y - foot.y) <= band && length(*seen - at) <= NearBands * band)
                heights.push_back(seen->y);
        }
    if (static_cast<double>(heights.size()) < CarriedShare * FootSteps * FootSteps) return std::nullopt;
    return upper_median(heights);
}

/// True for a box that lies in the picture with nothing in front of it.
bool is_free(const SeenView& view, const Vec3& foot, const Vec3& size) {
    int free = 0, all = 0;
    for (const double x : {-0.5, 0.0, 0.5})
        for (const double z : {-0.5, 0.0, 0.5})
            for (const double y : {TouchShare, 0.5, 1.0}) {
                free += view.sees(foot + Vec3{size.x * x, size.y * y, size.z * z});
                ++all;
            }
    return free >= ClearShare * all;
}

/// Foot on the support that brings the box nearest to the middle of the view; nothing where it has no room.
std::optional<Vec3> standing_place(const SeenView& view, const Vec3& size) {
    std::optional<Vec3> best;
    double least = std::numeric_limits<double>::infinity();
    const int step = std::max(1, view.width() / Columns);
    for (int y = step / 2; y < view.height(); y += step)
        for (int x = step / 2; x < view.width(); x += step) {
            if (!(view.depth(x, y) > 0)) continue;
            Vec3 foot = view.point(x, y);
            const double off = view.off_middle(foot + Vec3{0, size.y / 2, 0});
            if (off >= least) continue;
            const auto height = support_height(view, foot, size);
            if (!height) continue;
            foot.y = *height;
            if (is_free(view, foot, size)) best = foot, least = off;
        }
    return best;
}

/// In front of the nearest surface at the middle of the view.
SeenPlace hanging_place(const SeenView& view, const std::vector<double>& depths, const Vec3& size,
                        bool fixed) {
    const double near = depth_of_share(depths, NearShare), longest = std::max({size.x, size.y, size.z});
    SeenPlace place{{}, 1, true, false};
    double z = near - HalfDiagonal * longest;
    const double share = z > 0 ? view.share(longest, z) : std::numeric_limits<double>::infinity();
    if (!fixed && !(share >= LeastSeen && share <= MostSeen)) {
        z = near / (1 + HalfDiagonal * SeenShare / view.share(1, 1));
        place.factor = SeenShare / view.share(longest, z);
        place.suits = false;
    }
    z = std::max(z, NearestShare * near);
    place.foot =
        view.at_depth(0.5 * view.width(), 0.5 * view.height(), z) - Vec3{0, 0.5 * size.y * place.factor, 0};
    return place;
}

}  // namespace

bool SeenSurface::empty() const {
    return std::none_of(depth.data.begin(), depth.data.end(), [](float z) { return z > 0; });
}

SeenPlace seen_place(const SeenSurface& surface, const Vec3& size, bool fixed) {
    const SeenView view(surface);
    auto depths = depths_around_middle(view, WindowShare);
    if (depths.empty()) depths = depths_around_middle(view, 1);
    const double longest = std::max({size.x, size.y, size.z});
    const double share = view.share(longest, depth_of_share(depths, 0.5));
    const bool suits = fixed || (share >= LeastSeen && share <= MostSeen);
    for (const double smaller : Smaller) {
        const double factor = (suits ? 1 : SeenShare / share) * smaller;
        if (const auto foot = standing_place(view, size * factor))
            return {*foot, factor, suits && smaller == 1, true};
        if (fixed) break;
    }
    return hanging_place(view, depths, size, fixed);
}

}  // namespace gse
