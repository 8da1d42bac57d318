// Layers from the rim inwards, then smoothing.
#include "engine/edit/interfaces/clean_plate.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr std::array<std::pair<int, int>, 4> Sides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
constexpr int SmoothingSteps = 100;
constexpr float Opaque = 0.97f;  // less is in part the colour behind the scene
constexpr int RimPx = 3;         // of a hole, at most

bool within(const Image& image, int x, int y) {
    return x >= 0 && y >= 0 && x < image.width && y < image.height;
}

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
    for (std::size_t i = 0; i < holes.data.size(); ++i)
        holes.data[i] = depth.data[i] <= 0 && sky.data[i] == 0 ? 1 : 0;
    return holes;
}

/// The holes with those of their surroundings that are seen through in part.
Mask with_rims(const Mask& holes, const Mask& mask, const Image& alpha) {
    Mask wider = holes;
    for (int ring = 0; ring < RimPx; ++ring) {
        const Mask before = wider;
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x)
                if (before.at(x, y) == 0 && mask.at(x, y) != 0 && alpha.at(x, y, 0) < Opaque &&
                    std::any_of(Sides.begin(), Sides.end(), [&](const auto& side) {
                        return within(alpha, x + side.first, y + side.second) &&
                               before.at(x + side.first, y + side.second) != 0;
                    }))
                    wider.at(x, y) = 1;
    }
    return wider;
}

/// Mean of the neighbours that count, of all channels of both pictures, where the depth holds 1/z; false
/// where none counts.
bool take_mean(CleanPlate& clean_plate, int x, int y, const Mask& counts) {
    std::array<float, 4> sum{};
    int neighbours = 0;
    for (const auto& [dx, dy] : Sides) {
        if (!within(clean_plate.depth, x + dx, y + dy) || counts.at(x + dx, y + dy) == 0) continue;
        for (int c = 0; c < 3; ++c)
            sum[static_cast<std::size_t>(c)] += clean_plate.picture.at(x + dx, y + dy, c);
        sum[3] += clean_plate.depth.at(x + dx, y + dy, 0);
        ++neighbours;
    }
    if (neighbours == 0) return false;
    for (int c = 0; c < 3; ++c)
        clean_plate.picture.at(x, y, c) = sum[static_cast<std::size_t>(c)] / static_cast<float>(neighbours);
    clean_plate.depth.at(x, y, 0) = sum[3] / static_cast<float>(neighbours);
    return true;
}

}  // namespace

std::size_t fill_holes(CleanPlate& clean_plate, const Mask& mask, const Image& alpha) {
    GSE_CHECK(clean_plate.depth.width == mask.width && clean_plate.depth.height == mask.height);
    GSE_CHECK(alpha.width == mask.width && alpha.height == mask.height);
    clean_plate.filled = with_rims(holes_of(clean_plate.depth, mask), mask, alpha);
    const Image before = clean_plate.depth;
    for (auto& z : clean_plate.depth.data) z = z > 0 ? 1 / z : 0;
    std::vector<std::pair<int, int>> pixels;
    Mask known(mask.width, mask.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            const bool hole = clean_plate.filled.at(x, y) != 0;
            known.at(x, y) = !hole && clean_plate.depth.at(x, y, 0) > 0 ? 1 : 0;
            if (hole) pixels.emplace_back(x, y);
        }
    std::size_t left = pixels.size();
    while (left > 0) {
        std::vector<std::pair<int, int>> layer;
        for (const auto& [x, y] : pixels)
            if (known.at(x, y) == 0 && take_mean(clean_plate, x, y, known)) layer.emplace_back(x, y);
        if (layer.empty()) break;
        for (const auto& [x, y] : layer) known.at(x, y) = 1;
        left -= layer.size();
    }
    for (int step = 0; step < SmoothingSteps; ++step)
        for (const auto& [x, y] : pixels) take_mean(clean_plate, x, y, known);
    for (std::size_t i = 0; i < before.data.size(); ++i) {
        float& z = clean_plate.depth.data[i];
        z = clean_plate.filled.data[i] == 0 ? before.data[i] : z > 0 ? 1 / z : 0;
    }
    return pixels.size() - left;
}

}  // namespace gse::edit
