// Grid DBSCAN: core pixels by counting in a disc, components of cores, border pixels attached.
#include "engine/localize/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "engine/base/check.h"

namespace gse::localize {
namespace {

using Offset = std::array<int, 2>;

/// Offsets of all pixels within `radius`, nearest rows first.
std::vector<Offset> disc(double radius) {
    std::vector<Offset> offsets;
    const int reach = static_cast<int>(std::floor(radius));
    for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x)
            if (x * x + y * y <= radius * radius) offsets.push_back({x, y});
    return offsets;
}

/// Calls visit(index) for every pixel of the mask in reach of (x, y).
template <class F>
void for_neighbours(const Mask& mask, int x, int y, const std::vector<Offset>& offsets, F&& visit) {
    for (const auto& [dx, dy] : offsets) {
        const int u = x + dx, v = y + dy;
        if (u >= 0 && v >= 0 && u < mask.width && v < mask.height)
            visit(static_cast<std::size_t>(v) * static_cast<std::size_t>(mask.width) +
                  static_cast<std::size_t>(u));
    }
}

Mask core_pixels(const Mask& mask, const std::vector<Offset>& offsets, int min_samples) {
    Mask core(mask.width, mask.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            int count = 0;
            for_neighbours(mask, x, y, offsets, [&](std::size_t i) { count += mask.data[i] != 0 ? 1 : 0; });
            core.at(x, y) = count >= min_samples ? 1 : 0;
        }
    return core;
}

void flood(const Mask& core, std::size_t seed, int cluster, const std::vector<Offset>& offsets,
           std::vector<int>& clusters) {
    std::vector<std::size_t> open{seed};
    clusters[seed] = cluster;
    while (!open.empty()) {
        const std::size_t index = open.back();
        open.pop_back();
        const int x = static_cast<int>(index % static_cast<std::size_t>(core.width));
        const int y = static_cast<int>(index / static_cast<std::size_t>(core.width));
        for_neighbours(core, x, y, offsets, [&](std::size_t i) {
            if (core.data[i] == 0 || clusters[i] >= 0) return;
            clusters[i] = cluster;
            open.push_back(i);
        });
    }
}

}  // namespace

std::vector<int> dbscan(const Mask& mask, const DbscanParameters& parameters) {
    const auto offsets = disc(parameters.eps_px);
    const Mask core = core_pixels(mask, offsets, parameters.min_samples);
    std::vector<int> clusters(mask.data.size(), -1);
    int next = 0;
    for (std::size_t i = 0; i < core.data.size(); ++i)
        if (core.data[i] != 0 && clusters[i] < 0) flood(core, i, next++, offsets, clusters);
    const std::vector<int> of_cores = clusters;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            const auto index = static_cast<std::size_t>(y * mask.width + x);
            if (mask.data[index] == 0 || core.data[index] != 0) continue;
            for_neighbours(mask, x, y, offsets, [&](std::size_t i) {
                if (core.data[i] != 0 && (clusters[index] < 0 || of_cores[i] < clusters[index]))
                    clusters[index] = of_cores[i];
            });
        }
    return clusters;
}

Mask threshold_map(const Image& map, double threshold) {
    Mask mask(map.width, map.height);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = map.data[i] > threshold ? 1 : 0;
    return mask;
}

Mask clean_clusters(const Mask& mask, const Image& map, const DbscanParameters& parameters,
                    double keep_mass) {
    GSE_CHECK_EQ(mask.data.size(), map.data.size());
    const auto clusters = dbscan(mask, parameters);
    std::map<int, double> mass;
    for (std::size_t i = 0; i < clusters.size(); ++i)
        if (clusters[i] >= 0) mass[clusters[i]] += map.data[i];
    double largest = 0;
    for (const auto& [cluster, sum] : mass) largest = std::max(largest, sum);
    Mask result(mask.width, mask.height);
    for (std::size_t i = 0; i < clusters.size(); ++i)
        result.data[i] = clusters[i] >= 0 && mass[clusters[i]] >= keep_mass * largest ? 1 : 0;
    return result;
}

Mask flood_fill(const Mask& open, const Mask& from) {
    GSE_CHECK(open.width == from.width && open.height == from.height);
    Mask reached(open.width, open.height);
    std::vector<std::pair<int, int>> rim;
    const auto reach = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= open.width || y >= open.height || open.at(x, y) == 0 ||
            reached.at(x, y) != 0)
            return;
        reached.at(x, y) = 1;
        rim.emplace_back(x, y);
    };
    for (int y = 0; y < open.height; ++y)
        for (int x = 0; x < open.width; ++x)
            if (from.at(x, y) != 0) reach(x, y);
    while (!rim.empty()) {
        const auto [x, y] = rim.back();
        rim.pop_back();
        reach(x - 1, y), reach(x + 1, y), reach(x, y - 1), reach(x, y + 1);
    }
    return reached;
}

Mask without_holes(const Mask& mask) {
    Mask open(mask.width, mask.height), edge(mask.width, mask.height);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            open.at(x, y) = mask.at(x, y) == 0 ? 1 : 0;
            edge.at(x, y) = x == 0 || y == 0 || x + 1 == mask.width || y + 1 == mask.height ? 1 : 0;
        }
    Mask result = flood_fill(open, edge);
    for (auto& bit : result.data) bit = bit == 0 ? 1 : 0;
    return result;
}

Mask dilate(const Mask& mask, double radius_px) {
    const bool grow = radius_px >= 0;
    const double square = radius_px * radius_px;
    const int reach = static_cast<int>(std::floor(std::abs(radius_px))), width = mask.width,
              height = mask.height;
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    // Rows to the nearest pixel that spreads, in each column: then a pixel asks its row, not the whole disc.
    const int far = reach + 1;
    std::vector<int> rows(mask.data.size());
    for (int x = 0; x < width; ++x) {
        int distance = far;
        const auto pass = [&](int y) {
            distance = (mask.at(x, y) != 0) == grow ? 0 : std::min(distance + 1, far);
            rows[at(x, y)] = std::min(rows[at(x, y)], distance);
        };
        for (int y = 0; y < height; ++y) rows[at(x, y)] = far, pass(y);
        distance = far;
        for (int y = height - 1; y >= 0; --y) pass(y);
    }
    Mask result = mask;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if ((mask.at(x, y) != 0) == grow) continue;
            bool hit = false;
            for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach) && !hit; ++u) {
                const int dx = u - x, dy = rows[at(u, y)];
                hit = dy < far && dx * dx + dy * dy <= square;
            }
            if (hit) result.at(x, y) = grow ? 1 : 0;
        }
    return result;
}

PixelBox bounds_of(const Mask& mask) {
    int left = mask.width, right = -1, top = mask.height, bottom = -1;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            left = std::min(left, x), right = std::max(right, x);
            top = std::min(top, y), bottom = std::max(bottom, y);
        }
    return right < 0 ? PixelBox{} : PixelBox{left, top, right - left + 1, bottom - top + 1};
}

double mask_iou(const Mask& a, const Mask& b) {
    std::size_t both = 0, either = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) {
        both += a.data[i] != 0 && b.data[i] != 0 ? 1 : 0;
        either += a.data[i] != 0 || b.data[i] != 0 ? 1 : 0;
    }
    return either == 0 ? 0 : static_cast<double>(both) / static_cast<double>(either);
}

Mask resize_mask(const Mask& mask, int width, int height) {
    Mask result(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            result.at(x, y) = mask.at(std::min(mask.width - 1, (2 * x + 1) * mask.width / (2 * width)),
                                      std::min(mask.height - 1, (2 * y + 1) * mask.height / (2 * height)));
    return result;
}

namespace {

/// Input cells that one output coordinate covers, with their weights (area down, linear up).
struct Taps {
    int first = 0;
    std::vector<double> weights;
};

Taps taps(int position, int from, int to) {
    Taps result;
    const double scale = static_cast<double>(from) / to;
    if (scale <= 1) {
        const double centre = std::clamp((position + 0.5) * scale - 0.5, 0.0, from - 1.0);
        result.first = std::min(static_cast<int>(centre), std::max(0, from - 2));
        const double share = centre - result.first;
        result.weights = from > 1 ? std::vector<double>{1 - share, share} : std::vector<double>{1};
        return result;
    }
    const double begin = position * scale, end = begin + scale;
    result.first = static_cast<int>(begin);
    for (int cell = result.first; cell < end && cell < from; ++cell)
        result.weights.push_back((std::min(end, cell + 1.0) - std::max(begin, static_cast<double>(cell))) /
                                 scale);
    return result;
}

}  // namespace

Image resize_image(const Image& image, int width, int height) {
    if (image.width == width && image.height == height) return image;
    Image result(width, height, image.channels);
    std::vector<Taps> columns;
    for (int x = 0; x < width; ++x) columns.push_back(taps(x, image.width, width));
    for (int y = 0; y < height; ++y) {
        const Taps rows = taps(y, image.height, height);
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < image.channels; ++c) {
                double sum = 0;
                for (std::size_t j = 0; j < rows.weights.size(); ++j)
                    for (std::size_t i = 0; i < columns[static_cast<std::size_t>(x)].weights.size(); ++i)
                        sum += rows.weights[j] * columns[static_cast<std::size_t>(x)].weights[i] *
                               image.at(columns[static_cast<std::size_t>(x)].first + static_cast<int>(i),
                                        rows.first + static_cast<int>(j), c);
                result.at(x, y, c) = static_cast<float>(sum);
            }
    }
    return result;
}

}  // namespace gse::localize
