// Hues, and pieces of one hue.
#include "engine/remote/views/painted_part.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::remote {
namespace {

constexpr std::array<PaintColour, 6> Colours{{{"pure magenta (#FF00FF)", {1, 0, 1}},
                                              {"pure cyan (#00FFFF)", {0, 1, 1}},
                                              {"pure blue (#0000FF)", {0, 0, 1}},
                                              {"pure green (#00FF00)", {0, 1, 0}},
                                              {"pure yellow (#FFFF00)", {1, 1, 0}},
                                              {"pure red (#FF0000)", {1, 0, 0}}}};
constexpr double SameHue = 20, NearHue = 40;  // degrees
// Shading leaves saturation, and light lowers it.
constexpr double LeastSaturation = 0.5, LeastValue = 0.2;
constexpr double LeastPaintChange = 0.1;  // of a pixel that has the hue, in the channel that changed most
constexpr double LeastPainted = 0.003, MostPainted = 0.6;  // of the pixels
constexpr double LargePiece = 0.01, InLargePieces = 0.8;   // of the painted pixels

struct Hsv {
    double hue = 0, saturation = 0, value = 0;  // degrees, [0,1], [0,1]
};

Hsv hsv_of(const float* rgb) {
    const double most = std::max({rgb[0], rgb[1], rgb[2]}), least = std::min({rgb[0], rgb[1], rgb[2]}),
                 range = most - least;
    if (range <= 0 || most <= 0) return {0, 0, most};
    double sixth = 0;
    if (most == rgb[0]) sixth = (rgb[1] - rgb[2]) / range;
    else if (most == rgb[1]) sixth = 2 + (rgb[2] - rgb[0]) / range;
    else sixth = 4 + (rgb[0] - rgb[1]) / range;
    return {std::fmod(60 * sixth + 360, 360), range / most, most};
}

double angle_between(double one, double other) {
    const double turn = std::abs(one - other);
    return std::min(turn, 360 - turn);
}

bool has_hue(const float* pixel, double hue) {
    const auto seen = hsv_of(pixel);
    return seen.saturation >= LeastSaturation && seen.value >= LeastValue &&
           angle_between(seen.hue, hue) <= SameHue;
}

/// Share of the mask that lies in its large pieces.
double share_in_large_pieces(const Mask& mask) {
    const auto clusters = localize::dbscan(mask, {1.5, 1});
    std::vector<double> sizes;
    for (const int cluster : clusters) {
        if (cluster < 0) continue;
        sizes.resize(std::max(sizes.size(), static_cast<std::size_t>(cluster) + 1));
        sizes[static_cast<std::size_t>(cluster)] += 1;
    }
    const auto all = static_cast<double>(mask.count());
    double large = 0;
    for (const double size : sizes) large += size > LargePiece * all ? size : 0;
    return all > 0 ? large / all : 0;
}

}  // namespace

const PaintColour& rarest_colour(const Image& picture) {
    std::array<double, Colours.size()> seen{};
    for (std::size_t i = 0; i < picture.data.size(); i += 3) {
        const auto pixel = hsv_of(picture.data.data() + i);
        for (std::size_t c = 0; c < Colours.size(); ++c)
            if (angle_between(pixel.hue, hsv_of(Colours[c].rgb.data()).hue) <= NearHue)
                seen[c] += pixel.saturation * pixel.value;
    }
    return Colours[static_cast<std::size_t>(std::min_element(seen.begin(), seen.end()) - seen.begin())];
}

ChangedPart painted_part(const Image& before, const Image& after, const PaintColour& colour) {
    GSE_CHECK_EQ(before.data.size(), after.data.size());
    const double hue = hsv_of(colour.rgb.data()).hue;
    ChangedPart part;
    part.map = Image(before.width, before.height, 1);
    Mask mask(before.width, before.height);
    const Image change = change_map(before, after, 0);
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        mask.data[i] = change.data[i] >= LeastPaintChange && has_hue(after.data.data() + 3 * i, hue) ? 1 : 0;
    const double painted = static_cast<double>(mask.count()) / static_cast<double>(mask.data.size());
    part.mask = Mask(before.width, before.height);
    if (painted > MostPainted) part.found = ChangeFound::Everywhere;
    if (painted > MostPainted || painted < LeastPainted || share_in_large_pieces(mask) < InLargePieces)
        return part;
    Image weight(before.width, before.height, 1, 1.0f);
    part.mask = localize::without_holes(localize::clean_clusters(mask, weight, {1.5, 1}, LargePiece));
    for (std::size_t i = 0; i < part.mask.data.size(); ++i)
        part.map.data[i] = part.mask.data[i] != 0 ? 1.0f : 0.0f;
    part.level = LeastPaintChange;
    part.found = ChangeFound::Part;
    return part;
}

}  // namespace gse::remote
