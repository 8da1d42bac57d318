// A coarse grid finds the object, a second one fits it closely.
#include "engine/edit/placement/visual_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/check.h"
#include "engine/math/vec.h"

namespace gse::edit {
namespace {

constexpr int CoarseCells = 32;         // along the longest side of the box
constexpr int MostCells = 128;          // the same of the second grid
constexpr double LeastHullPart = 0.02;  // of the largest connected part: flames have many small ones
constexpr double HiddenSlack = 1.5;     // sides of a cube behind a surface: it may lie on it
// Half of a cube's width as it is seen, over its side: between face and corner.
constexpr double Footprint = 0.75;

constexpr float OutlineLevel = 0.5f;
constexpr std::array TriedShares{0.95, 0.85, 0.75, 0.65, 0.55, 0.45};  // from strict to loose

struct Pixel {
    double x = 0, y = 0, z = 0;
};

/// Pixel of a world point. Nothing when it is behind the camera or out of the picture.
std::optional<Pixel> project(const Camera& camera, const Vec3& point) {
    const Vec3 p = camera.to_camera(point);
    if (!(p.z > 0)) return std::nullopt;
    const Pixel pixel{camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy, p.z};
    if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x < camera.width && pixel.y < camera.height))
        return std::nullopt;
    return pixel;
}

/// Bilinear value of a channel between pixel centres.
double sample(const Image& image, double x, double y, int channel) {
    const double u = std::clamp(x - 0.5, 0.0, image.width - 1.0),
                 v = std::clamp(y - 0.5, 0.0, image.height - 1.0);
    const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
    const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
    const double a = u - x0, b = v - y0;
    return (1 - b) * ((1 - a) * image.at(x0, y0, channel) + a * image.at(x1, y0, channel)) +
           b * ((1 - a) * image.at(x0, y1, channel) + a * image.at(x1, y1, channel));
}

/// Cubes of a box, x fastest.
struct Cubes {
    Vec3 low;
    double side = 0;
    std::array<int, 3> count{};
    std::vector<std::uint8_t> inside;

    Cubes(const HullBox& box, double cube_side) : low(box.low), side(cube_side) {
        std::size_t size = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            count[i] = std::max(1, static_cast<int>(std::ceil((box.high[axis] - box.low[axis]) / side)));
            size *= static_cast<std::size_t>(count[i]);
        }
        inside.assign(size, 0);
    }
    std::array<int, 3> place(std::size_t cube) const {
        const auto nx = static_cast<std::size_t>(count[0]), ny = static_cast<std::size_t>(count[1]);
        return {static_cast<int>(cube % nx), static_cast<int>(cube / nx % ny),
                static_cast<int>(cube / (nx * ny))};
    }
    Vec3 centre(std::size_t cube) const {
        const auto [x, y, z] = place(cube);
        return low + Vec3{x + 0.5, y + 0.5, z + 0.5} * side;
    }
    std::size_t at(int x, int y, int z) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(count[0]) *
                   (static_cast<std::size_t>(y) +
                    static_cast<std::size_t>(count[1]) * static_cast<std::size_t>(z));
    }
    bool has(int x, int y, int z) const {
        return x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2] &&
               inside[at(x, y, z)] != 0;
    }
    std::size_t filled() const {
        return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), std::uint8_t{1}));
    }
};

void carve(Cubes& cubes, std::span<const HullView> views, const HullParameters& parameters) {
    for (std::size_t cube = 0; cube < cubes.inside.size(); ++cube) {
        const double share = hull_share(views, cubes.centre(cube), HiddenSlack * cubes.side, parameters);
        cubes.inside[cube] = share >= parameters.least_share ? 1 : 0;
    }
}

/// Drops parts that are small beside the largest.
void keep_large_parts(Cubes& cubes) {
    std::vector<int> part(cubes.inside.size(), -1);
    std::vector<std::size_t> sizes;
    std::vector<std::size_t> open;
    for (std::size_t first = 0; first < part.size(); ++first) {
        if (cubes.inside[first] == 0 || part[first] >= 0) continue;
        const int name = static_cast<int>(sizes.size());
        sizes.push_back(0);
        open.assign(1, first);
        part[first] = name;
        while (!open.empty()) {
            const auto [x, y, z] = cubes.place(open.back());
            open.pop_back();
            ++sizes.back();
            for (int k = 0; k < 6; ++k) {
                const int step = k % 2 == 0 ? -1 : 1;
                const int nx = x + (k / 2 == 0 ? step : 0), ny = y + (k / 2 == 1 ? step : 0),
                          nz = z + (k / 2 == 2 ? step : 0);
                if (!cubes.has(nx, ny, nz) || part[cubes.at(nx, ny, nz)] >= 0) continue;
                part[cubes.at(nx, ny, nz)] = name;
                open.push_back(cubes.at(nx, ny, nz));
            }
        }
    }
    const std::size_t largest = sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end());
    for (std::size_t cube = 0; cube < part.size(); ++cube)
        if (part[cube] >= 0 && static_cast<double>(sizes[static_cast<std::size_t>(part[cube])]) <
                                   LeastHullPart * static_cast<double>(largest))
            cubes.inside[cube] = 0;
}

/// Bounds of the cubes inside, with one more on every side.
HullBox bounds(const Cubes& cubes) {
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (std::size_t cube = 0; cube < cubes.inside.size(); ++cube) {
        if (cubes.inside[cube] == 0) continue;
        const Vec3 centre = cubes.centre(cube);
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], centre[axis]);
            high[axis] = std::max(high[axis], centre[axis]);
        }
    }
    const Vec3 margin = Vec3{1.5, 1.5, 1.5} * cubes.side;
    return {low - margin, high + margin};
}

/// Normal of a cube: away from the cubes nearby. Zero if they are on all sides.
Vec3 outwards(const Cubes& cubes, std::size_t cube) {
    const auto [x, y, z] = cubes.place(cube);
    Vec3 sum;
    bool surface = false;
    for (int dz = -2; dz <= 2; ++dz)
        for (int dy = -2; dy <= 2; ++dy)
            for (int dx = -2; dx <= 2; ++dx) {
                if (cubes.has(x + dx, y + dy, z + dz)) continue;
                sum = sum + Vec3{static_cast<double>(dx), static_cast<double>(dy), static_cast<double>(dz)};
                surface = surface || std::abs(dx) + std::abs(dy) + std::abs(dz) == 1;
            }
    if (!surface) return {};
    const double size = length(sum);
    return size > 1e-9 ? sum / size : Vec3{0, -1, 0};
}

/// Depth of the nearest cube in every pixel of a view; 0 = none.
Image depth_of(const VisualHull& hull, const Camera& camera) {
    Image depth(camera.width, camera.height, 1);
    for (const auto& centre : hull.centres) {
        const Vec3 p = camera.to_camera(centre);
        if (!(p.z > hull.side)) continue;
        const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
        const double radius = std::max(0.5, Footprint * hull.side * camera.fx / p.z);
        const auto from = [](double value, int size) {
            return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
        };
        for (int v = from(y - radius, depth.height); v < from(y + radius + 1, depth.height); ++v)
            for (int u = from(x - radius, depth.width); u < from(x + radius + 1, depth.width); ++u) {
                if (std::hypot(u + 0.5 - x, v + 0.5 - y) > radius) continue;
                float& nearest = depth.at(u, v, 0);
                if (nearest == 0 || p.z < nearest) nearest = static_cast<float>(p.z);
            }
    }
    return depth;
}

/// Mean colour of a cube over the views that show it, those that look straight at it first.
struct SeenColour {
    Vec3 sum;
    double weight = 0;
    void add(const Image& picture, const Pixel& at, double share) {
        for (int c = 0; c < 3; ++c) sum[c] += share * sample(picture, at.x, at.y, c);
        weight += share;
    }
};

/// Rotation (w, x, y, z) that takes the z axis to `normal`.
std::array<double, 4> turn_to(const Vec3& normal) {
    const double w = 1 + normal.z;
    if (w < 1e-6) return {0, 1, 0, 0};
    const double size = std::sqrt(w * w + normal.x * normal.x + normal.y * normal.y);
    return {w / size, -normal.y / size, normal.x / size, 0};
}

}  // namespace

double hull_share(std::span<const HullView> views, const Vec3& point, double slack,
                  const HullParameters& parameters) {
    int framed = 0, seen = 0, inside = 0;
    for (const auto& view : views) {
        const auto pixel = project(view.camera, point);
        if (!pixel) continue;
        ++framed;
        if (!view.surface.data.empty()) {
            const double surface = view.surface.at(static_cast<int>(pixel->x), static_cast<int>(pixel->y), 0);
            if (surface > 0 && pixel->z > surface + slack) continue;
        }
        ++seen;
        inside += sample(view.inside, pixel->x, pixel->y, 0) >= parameters.level ? 1 : 0;
    }
    const auto views_count = static_cast<double>(views.size());
    if (seen == 0 || seen < parameters.least_seen * views_count ||
        framed < parameters.least_framed * views_count)
        return -1;
    return static_cast<double>(inside) / seen;
}

VisualHull carve_hull(std::span<const HullView> views, const HullBox& box, const HullParameters& parameters) {
    for (const auto& view : views)
        GSE_CHECK(view.inside.width == view.camera.width && view.inside.height == view.camera.height);
    VisualHull hull;
    const Vec3 size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    if (!(longest > 0) || !std::isfinite(longest)) return hull;
    Cubes coarse(box, longest / CoarseCells);
    carve(coarse, views, parameters);
    keep_large_parts(coarse);
    if (coarse.filled() == 0) return hull;
    const auto close = bounds(coarse);
    const double volume = static_cast<double>(coarse.filled()) * std::pow(coarse.side, 3);
    const Vec3 close_size = close.high - close.low;
    const double least_side = std::max({close_size.x, close_size.y, close_size.z}) / MostCells;
    Cubes cubes(close, std::max(least_side, std::cbrt(volume / parameters.cells)));
    carve(cubes, views, parameters);
    keep_large_parts(cubes);
    hull.side = cubes.side;
    for (std::size_t cube = 0; cube < cubes.inside.size(); ++cube) {
        if (cubes.inside[cube] == 0) continue;
        hull.centres.push_back(cubes.centre(cube));
        hull.normals.push_back(outwards(cubes, cube));
    }
    return hull;
}

double hull_fit(std::span<const HullView> views, const VisualHull& hull) {
    double sum = 0;
    for (const auto& view : views) {
        const Image depth = depth_of(hull, view.camera);
        double both = 0, either = 0;
        for (std::size_t i = 0; i < depth.data.size(); ++i) {
            const float surface = view.surface.data.empty() ? 0 : view.surface.data[i];
            const bool seen =
                depth.data[i] > 0 && (surface <= 0 || depth.data[i] <= surface + HiddenSlack * hull.side);
            const bool inside = view.inside.data[i] >= OutlineLevel;
            both += seen && inside ? 1 : 0;
            either += seen || inside ? 1 : 0;
        }
        sum += either > 0 ? both / either : 0;
    }
    return views.empty() ? 0 : sum / static_cast<double>(views.size());
}

VisualHull best_hull(std::span<const HullView> views, const HullBox& box, HullParameters parameters) {
    VisualHull best;
    double most = 0;
    for (const double share : TriedShares) {
        parameters.least_share = share;
        auto hull = carve_hull(views, box, parameters);
        const double fit = hull_fit(views, hull);
        if (fit > most) most = fit, best = std::move(hull);
    }
    return best;
}

Mask hull_mask(const VisualHull& hull, const Camera& camera) {
    const Image depth = depth_of(hull, camera);
    Mask mask(camera.width, camera.height);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = depth.data[i] > 0 ? 1 : 0;
    return mask;
}

void append_splat(GaussianData& data, const PlainSplat& splat) {
    const std::size_t row = data.size();
    data.resize(row + 1);
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = row * 3 + static_cast<std::size_t>(axis);
        data.position[i] = static_cast<float>(splat.centre[axis]);
        data.log_scale[i] = static_cast<float>(std::log(splat.deviation[axis]));
        data.sh[row * data.sh_stride() + static_cast<std::size_t>(axis)] =
            static_cast<float>(sh_from_colour(std::clamp(splat.colour[axis], 0.0, 1.0)));
    }
    for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = static_cast<float>(splat.rotation[i]);
    data.opacity_logit[row] = static_cast<float>(std::log(splat.opacity / (1 - splat.opacity)));
}

GaussianData hull_seeds(const VisualHull& hull, std::span<const HullView> views, int sh_degree,
                        double opacity) {
    constexpr double AlongSurface = 0.6, ThroughSurface = 0.25,
                     Within = 0.5;          // standard deviations over the side of a cube
    constexpr std::size_t EveryWithin = 4;  // of the cubes that nobody sees so many get no row
    std::vector<Image> depths;
    for (const auto& view : views) depths.push_back(depth_of(hull, view.camera));
    GaussianData data;
    data.sh_degree = sh_degree;
    for (std::size_t cube = 0; cube < hull.centres.size(); ++cube) {
        const Vec3 &centre = hull.centres[cube], &normal = hull.normals[cube];
        const bool surface = dot(normal, normal) > 0;
        if (!surface && cube % EveryWithin != 0) continue;
        SeenColour front, any;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const auto pixel = project(views[v].camera, centre);
            if (!pixel || sample(views[v].inside, pixel->x, pixel->y, 0) < 0.5) continue;
            any.add(views[v].picture, *pixel, 1);
            const double nearest = depths[v].at(static_cast<int>(pixel->x), static_cast<int>(pixel->y), 0);
            const double facing = dot(normal, normalized(views[v].camera.centre() - centre));
            if (surface && facing > 0 && pixel->z <= nearest + HiddenSlack * hull.side)
                front.add(views[v].picture, *pixel, facing * facing);
        }
        const auto& seen = front.weight > 0 ? front : any;
        if (!(seen.weight > 0)) continue;
        const Vec3 along{AlongSurface, AlongSurface, ThroughSurface}, within{Within, Within, Within};
        append_splat(data, {centre, (surface ? along : within) * hull.side, seen.sum / seen.weight,
                            surface ? turn_to(normal) : std::array<double, 4>{1, 0, 0, 0}, opacity});
    }
    return data;
}

}  // namespace gse::edit
