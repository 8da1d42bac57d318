// The thing that grows from the middle of its outline, and what the label has beside it.
#include "engine/pipeline/select/box_support.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"
#include "engine/localize/grow_thing.h"
#include "engine/math/unproject.h"

namespace gse::pipeline {
namespace {

constexpr float Covered = 0.5f;  // alpha
constexpr double Within = 0.85;  // of the grown thing is labelled: else the box holds a part of it
constexpr double Most = 0.4;     // of the label is the grown thing
constexpr double Least = 0.11;   // of the label is the support: less may be the thing's foot
constexpr double Ring = 0.04;    // of the support's longer side in the picture: width of a ring around it
constexpr double GoesOn = 0.4;   // of that ring shows more of the support (a pedestal stands on the ground)

/// Covered pixel of the mask that lies nearest to the middle of its pixels.
std::optional<std::pair<int, int>> middle_of(const Mask& mask, const Image& alpha) {
    double x = 0, y = 0, count = 0;
    for (int v = 0; v < mask.height; ++v)
        for (int u = 0; u < mask.width; ++u)
            if (mask.at(u, v) != 0) x += u, y += v, ++count;
    std::optional<std::pair<int, int>> nearest;
    double least = 0;
    for (int v = 0; v < mask.height; ++v)
        for (int u = 0; u < mask.width; ++u) {
            if (mask.at(u, v) == 0 || !(alpha.at(u, v, 0) > Covered)) continue;
            const double squared = std::pow(u - x / count, 2.0) + std::pow(v - y / count, 2.0);
            if (!nearest || squared < least) nearest = {u, v}, least = squared;
        }
    return nearest;
}

/// Labelled rows beside the thing; empty where the label is another thing than what grew.
std::vector<std::uint8_t> rows_beside(const std::vector<std::uint8_t>& bits,
                                      const std::vector<std::uint8_t>& thing) {
    std::vector<std::uint8_t> beside(bits.size(), 0);
    double labelled = 0, grown = 0, both = 0;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        labelled += bits[row], grown += thing[row], both += bits[row] & thing[row];
        beside[row] = bits[row] != 0 && thing[row] == 0 ? 1 : 0;
    }
    const bool same =
        grown > 0 && both >= Within * grown && both >= Most * labelled && labelled - both >= Least * labelled;
    return same ? beside : std::vector<std::uint8_t>{};
}

/// Pixels of the picture that mainly show the rows.
Mask shown(const GaussianSet& set, const std::vector<std::uint8_t>& rows, const Camera& camera,
           const raster::Settings& settings, Painter& painter) {
    Image values;
    const std::vector<float> weights(rows.begin(), rows.end());
    painter.rasterizer().forward_values(set.spans(), camera, settings, weights, values);
    Mask mask(camera.width, camera.height);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = values.data[i] > Covered ? 1 : 0;
    return mask;
}

/// Tells whether what surrounds the support in the picture is more of it. `thing` is no surrounding.
bool goes_on(const Mask& support, const Mask& thing, const Mask& level) {
    constexpr double least = 2;  // pixels
    const auto bounds = localize::bounds_of(support);
    const Mask wide =
        localize::dilate(support, std::max(least, Ring * std::max(bounds.width, bounds.height)));
    double around = 0, more = 0;
    for (std::size_t i = 0; i < wide.data.size(); ++i) {
        if (wide.data[i] == 0 || support.data[i] != 0 || thing.data[i] != 0) continue;
        around += 1, more += level.data[i];
    }
    return more > GoesOn * around;
}

}  // namespace

std::vector<std::uint8_t> without_support(const GaussianSet& set, std::vector<std::uint8_t> bits,
                                          const BoxedView& view, const raster::Settings& settings,
                                          Painter& painter) {
    GSE_CHECK_EQ(bits.size(), set.size());
    const auto& picture = view.picture;
    const auto pixel = middle_of(view.mask, picture.alpha);
    if (!pixel) return bits;
    const auto [x, y] = *pixel;
    const auto depth = static_cast<double>(picture.depth.at(x, y, 0) / picture.alpha.at(x, y, 0));
    localize::GrowRequest grow;
    grow.seed = unprojected(view.camera, x + 0.5, y + 0.5, depth);
    grow.up = view.up;
    grow.extent = depth * view.extent;
    const auto thing = localize::grow_thing(set.spans(), grow);
    if (!thing.from_support) return bits;
    const auto beside = rows_beside(bits, thing.rows);
    if (beside.empty()) return bits;
    const Mask support = shown(set, beside, view.camera, settings, painter);
    const Mask level = level_with(support, picture, view.camera.fx);
    const Mask body = shown(set, thing.rows, view.camera, settings, painter);
    if (!goes_on(support, body, level)) return bits;
    for (std::size_t row = 0; row < bits.size(); ++row)
        bits[row] = bits[row] != 0 && beside[row] == 0 ? 1 : 0;
    return bits;
}

}  // namespace gse::pipeline
