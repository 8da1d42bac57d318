// Greedy choice of clicks.
#include "engine/localize/points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/localize/clusters.h"

namespace gse::localize {
namespace {

double square_distance(const Point& a, double x, double y) {
    return (a.x - x) * (a.x - x) + (a.y - y) * (a.y - y);
}

/// Nearest of `points` of the wanted sign, squared; infinity without any.
double nearest(const std::vector<Point>& points, bool positive, double x, double y) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& point : points)
        if (point.positive == positive) best = std::min(best, square_distance(point, x, y));
    return best;
}

/// Diameter of the region's bounding box.
double region_diameter(const Mask& region) {
    const PixelBox box = bounds_of(region);
    return std::hypot(box.width, box.height);
}

/// Best allowed pixel for one more point; false when there is none.
bool add_point(const Image& map, const Mask& allowed, bool positive, double spacing,
               std::vector<Point>& points) {
    Point best;
    double best_value = 0, best_distance = 0;
    bool found = false;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            if (allowed.at(x, y) == 0 || nearest(points, positive, x + 0.5, y + 0.5) < spacing * spacing)
                continue;
            const double value = positive ? map.at(x, y, 0) : -map.at(x, y, 0);
            const double distance = positive ? 0 : nearest(points, true, x + 0.5, y + 0.5);
            if (found && (value < best_value || (value == best_value && distance <= best_distance))) continue;
            best = {x + 0.5, y + 0.5, positive};
            best_value = value;
            best_distance = distance;
            found = true;
        }
    if (found) points.push_back(best);
    return found;
}

}  // namespace

std::vector<Point> choose_points(const Image& map, const Mask& region, const PointParameters& parameters) {
    std::vector<Point> points;
    const double pixel = map.width / 64.0;
    const double spacing = std::max(2 * pixel, parameters.positive_spacing * region_diameter(region));
    for (int i = 0; i < parameters.positive; ++i)
        if (!add_point(map, region, true, spacing, points)) break;
    Mask outside = dilate(region, parameters.negative_margin * map.width);
    for (auto& value : outside.data) value = value != 0 ? 0 : 1;
    for (int i = 0; i < parameters.negative; ++i)
        if (!add_point(map, outside, false, parameters.negative_spacing * map.width, points)) break;
    return points;
}

double captured_mass(const Image& map, const Mask& region, const Mask& mask) {
    double inside = 0, all = 0;
    for (std::size_t i = 0; i < region.data.size(); ++i) {
        if (region.data[i] == 0) continue;
        all += map.data[i];
        if (mask.data[i] != 0) inside += map.data[i];
    }
    return all > 0 ? inside / all : 0;
}

}  // namespace gse::localize
