// Points looked up in other views by depth.
#include "engine/remote/views/depth_warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/check.h"
#include "engine/edit/request/scales.h"
#include "engine/localize/clusters.h"
#include "engine/math/quantile.h"
#include "engine/math/unproject.h"

namespace gse::remote {
namespace {

constexpr double SameDepth = 0.01;
constexpr double LeastCosine = 0.342;  // of 70 degrees
constexpr double RimPx = 2;            // of a picture of ReferenceSide

using Colour = std::array<float, 3>;

Vec3 point_of(const edit::EditView& view, int x, int y) {
    return unprojected(view.view.camera, x + 0.5, y + 0.5, static_cast<double>(view.depth.at(x, y, 0)));
}

/// Cosine between the surface's normal at a pixel and the ray to it; 0 where its neighbours show nothing.
double facing(const edit::EditView& view, int x, int y) {
    const int right = std::min(x + 1, view.depth.width - 1), below = std::min(y + 1, view.depth.height - 1);
    const int left = std::max(0, right - 2), above = std::max(0, below - 2);
    for (const auto& [px, py] : {std::array{right, y}, {left, y}, {x, below}, {x, above}})
        if (!(view.depth.at(px, py, 0) > 0)) return 0;
    const Vec3 normal = cross(point_of(view, right, y) - point_of(view, left, y),
                              point_of(view, x, below) - point_of(view, x, above));
    const Vec3 ray = point_of(view, x, y) - view.view.camera.centre();
    const double size = length(normal) * length(ray);
    return size > 0 ? std::abs(dot(normal, ray)) / size : 0;
}

/// Bilinear colour; places are in pixels, a pixel's centre at its index + 0.5.
Colour sampled(const Image& picture, double x, double y) {
    x = std::clamp(x - 0.5, 0.0, picture.width - 1.0), y = std::clamp(y - 0.5, 0.0, picture.height - 1.0);
    const int x0 = std::min(static_cast<int>(x), picture.width - 2);
    const int y0 = std::min(static_cast<int>(y), picture.height - 2);
    const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
    Colour colour{};
    for (int c = 0; c < 3; ++c)
        colour[static_cast<std::size_t>(c)] =
            (1 - v) * ((1 - u) * picture.at(x0, y0, c) + u * picture.at(x0 + 1, y0, c)) +
            v * ((1 - u) * picture.at(x0, y0 + 1, c) + u * picture.at(x0 + 1, y0 + 1, c));
    return colour;
}

/// Colour of a point in a view's picture; nothing where the view does not show it.
std::optional<Colour> shown_by(const edit::EditView& view, const Image& picture, const Vec3& point) {
    const Camera& camera = view.view.camera;
    const Vec3 seen = camera.to_camera(point);
    if (!(seen.z > 0)) return std::nullopt;
    const double x = camera.fx * seen.x / seen.z + camera.cx, y = camera.fy * seen.y / seen.z + camera.cy;
    if (!(x >= 0 && y >= 0 && x < view.depth.width && y < view.depth.height)) return std::nullopt;
    const int px = static_cast<int>(x), py = static_cast<int>(y);
    const double depth = view.depth.at(px, py, 0);
    if (!(depth > 0) || std::abs(depth - seen.z) > SameDepth * seen.z) return std::nullopt;
    if (view.mask.at(px, py) == 0 || facing(view, px, py) < LeastCosine) return std::nullopt;
    return sampled(picture, x, y);
}

Mask without_rim(const Mask& known, const Mask& allowed) {
    Mask unknown(known.width, known.height);
    for (std::size_t i = 0; i < known.data.size(); ++i)
        unknown.data[i] = allowed.data[i] != 0 && known.data[i] == 0 ? 1 : 0;
    const auto grown = localize::dilate(unknown, RimPx * known.width / edit::ReferenceSide);
    Mask result = known;
    for (std::size_t i = 0; i < known.data.size(); ++i)
        if (grown.data[i] != 0) result.data[i] = 0;
    return result;
}

}  // namespace

WarpedView warp_by_depth(const std::vector<const edit::EditView*>& from,
                         const std::vector<const Image*>& pictures, const edit::EditView& to) {
    GSE_CHECK_EQ(from.size(), pictures.size());
    WarpedView warped{to.rendered, Mask(to.mask.width, to.mask.height)};
    std::array<std::vector<float>, 3> values;
    for (int y = 0; y < to.mask.height; ++y)
        for (int x = 0; x < to.mask.width; ++x) {
            if (to.mask.at(x, y) == 0 || !(to.depth.at(x, y, 0) > 0)) continue;
            const Vec3 point = point_of(to, x, y);
            for (auto& channel : values) channel.clear();
            for (std::size_t v = 0; v < from.size(); ++v)
                if (const auto colour = shown_by(*from[v], *pictures[v], point))
                    for (std::size_t c = 0; c < 3; ++c) values[c].push_back((*colour)[c]);
            if (values[0].empty()) continue;
            warped.known.at(x, y) = 1;
            for (int c = 0; c < 3; ++c)
                warped.picture.at(x, y, c) = upper_median(values[static_cast<std::size_t>(c)]);
        }
    warped.known = without_rim(warped.known, to.mask);
    for (std::size_t i = 0; i < warped.known.data.size(); ++i)
        if (warped.known.data[i] == 0)
            for (std::size_t c = 0; c < 3; ++c) warped.picture.data[i * 3 + c] = to.rendered.data[i * 3 + c];
    return warped;
}

}  // namespace gse::remote
