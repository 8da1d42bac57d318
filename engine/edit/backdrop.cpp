// Layers from the rim inwards, then smoothing.
#include "engine/edit/backdrop.h"

#include <array>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr std::array<std::pair<int, int>, 4> Sides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
constexpr int SmoothingSteps = 20;

bool within(const Image& image, int x, int y) { return x >= 0 && y >= 0 && x < image.width && y < image.height; }

/// 1 where nothing is and sky is not.
Mask holes_of(const Image& depth, const Mask& mask) {
    Mask empty(depth.width, depth.height), beyond(depth.width, depth.height);
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) {
            const bool rim = x == 0 || y == 0 || x + 1 == depth.width || y + 1 == depth.height;
            empty.at(x, y) = depth.at(x, y, 0) <= 0 ? 1 : 0;
            beyond.at(x, y) = rim || mask.at(x, y) == 0 ? 1 : 0;
        }
    const Mask sky = localize::flood_fill(empty, beyond);
    Mask holes(depth.width, depth.height);
    for (std::size_t i = 0; i < holes.data.size(); ++i) holes.data[i] = depth.data[i] <= 0 && sky.data[i] == 0 ? 1 : 0;
    return holes;
}

/// Mean of the neighbours that count, of all channels of both pictures; false where none counts.
bool take_mean(Backdrop& backdrop, int x, int y, const Mask& counts) {
    std::array<float, 4> sum{};
    int neighbours = 0;
    for (const auto& [dx, dy] : Sides) {
        if (!within(backdrop.depth, x + dx, y + dy) || counts.at(x + dx, y + dy) == 0) continue;
        for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += backdrop.picture.at(x + dx, y + dy, c);
        sum[3] += backdrop.depth.at(x + dx, y + dy, 0);
        ++neighbours;
    }
    if (neighbours == 0) return false;
    for (int c = 0; c < 3; ++c) backdrop.picture.at(x, y, c) = sum[static_cast<std::size_t>(c)] / static_cast<float>(neighbours);
    backdrop.depth.at(x, y, 0) = sum[3] / static_cast<float>(neighbours);
    return true;
}

}  // namespace

std::size_t fill_holes(Backdrop& backdrop, const Mask& mask) {
    GSE_CHECK(backdrop.depth.width == mask.width && backdrop.depth.height == mask.height);
    const Mask holes = holes_of(backdrop.depth, mask);
    std::vector<std::pair<int, int>> pixels;
    Mask known(mask.width, mask.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            known.at(x, y) = backdrop.depth.at(x, y, 0) > 0 ? 1 : 0;
            if (holes.at(x, y) != 0) pixels.emplace_back(x, y);
        }
    for (std::size_t left = pixels.size(); left > 0;) {
        std::vector<std::pair<int, int>> layer;
        for (const auto& [x, y] : pixels)
            if (known.at(x, y) == 0 && take_mean(backdrop, x, y, known)) layer.emplace_back(x, y);
        if (layer.empty()) break;
        for (const auto& [x, y] : layer) known.at(x, y) = 1;
        left -= layer.size();
    }
    for (int step = 0; step < SmoothingSteps; ++step)
        for (const auto& [x, y] : pixels) take_mean(backdrop, x, y, known);
    return pixels.size();
}

}  // namespace gse::edit
