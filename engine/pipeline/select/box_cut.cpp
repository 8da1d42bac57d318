// Pixels on either side of the box's edges, counted.
#include "engine/pipeline/select/box_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::pipeline {
namespace {

constexpr float Solid = 0.5f;      // alpha
constexpr double LeastCut = 0.15;  // of the mask's width or height, along a side that cuts
// From a side to where the mask is looked at inside, and to where the thing goes on outside.
constexpr double Margin = 0.03;  // of the box's shorter side
constexpr int LeastMargin = 2;   // pixels

/// Pixel in or beyond the picture.
bool is_set(const Mask& mask, int x, int y) {
    return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.at(x, y) != 0;
}

}  // namespace

Mask level_with(const Mask& mask, const PictureDepth& picture, double focal) {
    constexpr double trim = 0.02, gap = 0.1;  // of the depths; of the mask's longer side
    std::vector<float> depths;
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0 && picture.alpha.data[i] > Solid)
            depths.push_back(picture.depth.data[i] / picture.alpha.data[i]);
    Mask level(mask.width, mask.height);
    if (depths.empty()) return level;
    std::sort(depths.begin(), depths.end());
    const auto at = [&](double share) {
        return static_cast<double>(
            depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))]);
    };
    const auto box = localize::bounds_of(mask);
    const double reach = gap * std::max(box.width, box.height) / focal * at(0.5);
    for (std::size_t i = 0; i < level.data.size(); ++i) {
        if (!(picture.alpha.data[i] > Solid)) continue;
        const auto depth = static_cast<double>(picture.depth.data[i] / picture.alpha.data[i]);
        level.data[i] = depth > at(trim) - reach && depth < at(1 - trim) + reach ? 1 : 0;
    }
    return level;
}

CutSides cut_sides(const Mask& mask, const Mask& level, const edit::BoxPrompt& box) {
    GSE_CHECK(mask.width == level.width && mask.height == level.height);
    const auto low = [](double side) { return static_cast<int>(std::floor(side)); };
    const int left = low(box.x0), right = low(box.x1) - 1, top = low(box.y0), bottom = low(box.y1) - 1;
    const double shorter = std::min(box.x1 - box.x0, box.y1 - box.y0);
    const int margin = std::max(LeastMargin, static_cast<int>(std::lround(Margin * shorter)));
    int above = 0, below = 0, to_left = 0, to_right = 0;
    const auto cut = [&](int x, int y, int out_x, int out_y) {
        return is_set(mask, x, y) && is_set(level, out_x, out_y) ? 1 : 0;
    };
    for (int x = left; x <= right; ++x) {
        above += cut(x, top + margin, x, top - margin);
        below += cut(x, bottom - margin, x, bottom + margin);
    }
    for (int y = top; y <= bottom; ++y) {
        to_left += cut(left + margin, y, left - margin, y);
        to_right += cut(right - margin, y, right + margin, y);
    }
    const auto bounds = localize::bounds_of(mask);
    const auto most = [](int pixels, int of) { return pixels > 0 && pixels >= LeastCut * of; };
    return {most(above, bounds.width), most(below, bounds.width), most(to_left, bounds.height),
            most(to_right, bounds.height)};
}

std::string sides_text(const CutSides& sides) {
    std::string text;
    for (const auto& [cuts, name] : {std::pair{sides.above, "above"}, std::pair{sides.left, "to the left"},
                                     std::pair{sides.right, "to the right"}})
        if (cuts) text += (text.empty() ? "" : " and ") + std::string(name);
    return text;
}

}  // namespace gse::pipeline
