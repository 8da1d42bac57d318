// Holes into the world, a plane through them, squares on it.
#include "engine/edit/target_views/ground_hole_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "engine/edit/placement/visual_hull.h"
#include "engine/math/eigen.h"
#include "engine/math/quantile.h"
#include "engine/math/unproject.h"

namespace gse::edit {
namespace {

constexpr double SquarePx = 1.5;  // side of a square, in pixels of the views
constexpr double Slack = 2;       // sides of a square by which depths may differ and be the same surface
constexpr std::size_t LeastWitnesses = 2;                    // that have a square in a hole
constexpr double AlongSurface = 0.6, ThroughSurface = 0.15;  // standard deviations over the side of a square

struct Point {
    Vec3 position, colour;
};

struct Holes {
    std::vector<Point> points;  // of all views
    double pixel = 0;           // width of a pixel there, world units, median
};

Holes points_in_holes(const std::vector<EditView>& views) {
    Holes holes;
    std::vector<double> pixels;
    for (const auto& view : views) {
        const auto& [picture, depth, filled] = view.clean_plate;
        const Camera& camera = view.view.camera;
        for (int y = 0; y < filled.height; ++y)
            for (int x = 0; x < filled.width; ++x) {
                const double z = depth.at(x, y, 0);
                if (filled.at(x, y) == 0 || !(z > 0)) continue;
                holes.points.push_back({unprojected(camera, x + 0.5, y + 0.5, z),
                                        {picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2)}});
                pixels.push_back(z / camera.fx);
            }
    }
    if (pixels.empty()) return holes;
    holes.pixel = upper_median(pixels);
    return holes;
}

/// Origin and axes of a plane, the third across it.
struct Plane {
    Vec3 origin;
    std::array<Vec3, 3> axis{};
    double along(int k, const Vec3& p) const { return dot(axis[static_cast<std::size_t>(k)], p - origin); }
    Vec3 point(double u, double v, double height) const {
        return origin + axis[0] * u + axis[1] * v + axis[2] * height;
    }
};

Plane plane_of(const std::vector<Point>& points) {
    Plane plane;
    for (const auto& p : points)
        plane.origin = plane.origin + p.position / static_cast<double>(points.size());
    Mat3 spread;
    for (const auto& p : points) {
        const Vec3 d = p.position - plane.origin;
        for (int row = 0; row < 3; ++row)
            for (int column = row; column < 3; ++column) spread(row, column) += d[row] * d[column];
    }
    plane.axis = symmetric_eigen(spread).axis;
    if (dot(cross(plane.axis[0], plane.axis[1]), plane.axis[2]) < 0)
        plane.axis[2] = plane.axis[2] * -1.0;  // a rotation, no mirror
    return plane;
}

struct Square {
    std::vector<double> heights;
    Vec3 colour;  // sum
    double height() { return upper_median(heights); }
};

/// Tells whether the views bear it out that there is a surface at the point.
bool borne_out(const std::vector<EditView>& views, const Vec3& point, double slack) {
    std::size_t agree = 0, against = 0;
    for (const auto& view : views) {
        const Camera& camera = view.view.camera;
        const Vec3 p = camera.to_camera(point);
        if (!(p.z > 0)) continue;
        const double px = camera.fx * p.x / p.z + camera.cx, py = camera.fy * p.y / p.z + camera.cy;
        const auto& clean_plate = view.clean_plate;
        if (!(px >= 0 && py >= 0 && px < clean_plate.depth.width && py < clean_plate.depth.height)) continue;
        const int x = static_cast<int>(px), y = static_cast<int>(py);
        const double z = clean_plate.depth.at(x, y, 0);
        if (!clean_plate.filled.data.empty() && clean_plate.filled.at(x, y) != 0)
            agree += std::abs(z - p.z) <= slack ? 1 : 0;
        else against += z <= 0 || p.z < z - slack ? 1 : 0;  // it would hide the sky, or what lies behind
    }
    return agree >= std::min(LeastWitnesses, views.size()) && agree > against;
}

}  // namespace

GaussianData ground_hole_fill(const std::vector<EditView>& views, int sh_degree, double opacity) {
    GaussianData data;
    data.sh_degree = sh_degree;
    const Holes holes = points_in_holes(views);
    if (holes.points.size() < 3) return data;
    const Plane plane = plane_of(holes.points);
    const double side = SquarePx * holes.pixel;
    std::map<std::pair<long, long>, Square> squares;
    for (const auto& p : holes.points) {
        auto& square = squares[{std::lround(plane.along(0, p.position) / side),
                                std::lround(plane.along(1, p.position) / side)}];
        square.heights.push_back(plane.along(2, p.position));
        square.colour = square.colour + p.colour;
    }
    const Quat turn = quaternion(Mat3::from_columns(plane.axis[0], plane.axis[1], plane.axis[2]));
    for (auto& [place, square] : squares) {
        const auto count = static_cast<double>(square.heights.size());
        const Vec3 centre = plane.point(static_cast<double>(place.first) * side,
                                        static_cast<double>(place.second) * side, square.height());
        if (!borne_out(views, centre, Slack * side)) continue;
        append_splat(data, {centre,
                            Vec3{AlongSurface, AlongSurface, ThroughSurface} * side,
                            square.colour / count,
                            {turn.w, turn.x, turn.y, turn.z},
                            opacity});
    }
    return data;
}

}  // namespace gse::edit
