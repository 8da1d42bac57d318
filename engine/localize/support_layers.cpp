// Flats, colours, and the voxels between.
#include "engine/localize/support_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/localize/clusters.h"

namespace gse::localize {
namespace {

using Colour = std::array<float, 3>;

constexpr int Window = 6;    // layers that a cross-section is taken from
constexpr int Sectors = 16;  // directions
constexpr int SomeSectors = 7, ManySectors = 8, NearlyAllSectors = 14;
constexpr double OtherColour = 1.2;  // contrast()
constexpr double Tall = 0.5;         // height of what stands there, in sides of its cross-section
constexpr double LeastShare = 0.03;  // of the members on either side: less is no thing
constexpr int RunGap = 4;            // layers between evidence of one support

/// Layers over `z` whose columns are the cross-section above it.
constexpr int above(int z) { return z + 2; }

Mask closed(const Mask& columns) {
    Mask mask = dilate(without_holes(dilate(columns, 2)), -2);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] |= columns.data[i];
    return mask;
}

/// Distance of the mean colours of two groups, in their standard deviations; 0 for groups of too few.
double contrast(const std::vector<Colour>& a, const std::vector<Colour>& b) {
    constexpr std::size_t few = 3;
    constexpr double noise = 0.02;  // least standard deviation
    if (a.size() < few || b.size() < few) return 0;
    const auto moments = [](const std::vector<Colour>& colours, std::size_t c) {
        double sum = 0, squares = 0;
        for (const auto& colour : colours) {
            const auto value = static_cast<double>(colour[c]);
            sum += value, squares += value * value;
        }
        const double mean = sum / static_cast<double>(colours.size());
        return std::pair{mean, std::max(0.0, squares / static_cast<double>(colours.size()) - mean * mean)};
    };
    double result = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto [mean_a, variance_a] = moments(a, c);
        const auto [mean_b, variance_b] = moments(b, c);
        result += (mean_a - mean_b) * (mean_a - mean_b) / (variance_a + variance_b + noise * noise);
    }
    return std::sqrt(result);
}

std::vector<Colour> colours_of(const VoxelGrid& grid, const VoxelSet& set, int low, int high,
                               const Mask* columns) {
    std::vector<Colour> colours;
    for (int z = std::max(0, low); z < std::min(high, grid.dimensions()[2]); ++z)
        for (const auto voxel : grid.layer(z)) {
            const auto& place = grid.place(voxel);
            if (set[voxel] != 0 && (columns == nullptr || columns->at(place[0], place[1]) != 0))
                colours.push_back(grid.colour(voxel));
        }
    return colours;
}

/// Number of directions in which the flat reaches out beyond the section.
int sectors_reached(const Mask& section, const Mask& flat) {
    constexpr double beyond = 1.5, reach = 8, filled = 0.5;  // voxels; share of the ring
    double sum_x = 0, sum_y = 0, count = 0;
    for (int y = 0; y < section.height; ++y)
        for (int x = 0; x < section.width; ++x)
            if (section.at(x, y) != 0) sum_x += x, sum_y += y, ++count;
    const double centre_x = sum_x / count, centre_y = sum_y / count;
    const auto sector_of = [&](int x, int y) {
        const double turn =
            (std::atan2(y - centre_y, x - centre_x) + std::numbers::pi) / (2 * std::numbers::pi);
        return static_cast<std::size_t>(static_cast<int>(turn * Sectors) % Sectors);
    };
    std::array<double, Sectors> rim{}, farthest{}, number{};
    const auto each = [&](const Mask& mask, const auto& take) {
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x)
                if (mask.at(x, y) != 0) take(sector_of(x, y), std::hypot(x - centre_x, y - centre_y));
    };
    each(section, [&](std::size_t sector, double radius) { rim[sector] = std::max(rim[sector], radius); });
    each(flat, [&](std::size_t sector, double radius) {
        if (radius > rim[sector]) farthest[sector] = std::max(farthest[sector], radius), ++number[sector];
    });
    int reached = 0;
    for (std::size_t sector = 0; sector < Sectors; ++sector) {
        const double outer = std::min(farthest[sector], rim[sector] + reach);
        const double ring = (outer * outer - rim[sector] * rim[sector]) * std::numbers::pi / Sectors;
        if (farthest[sector] >= rim[sector] + beyond && number[sector] >= filled * std::max(1.0, ring))
            ++reached;
    }
    return reached;
}

/// Evidence that what lies above a layer stands on it.
struct Evidence {
    int sectors = 0;
    double contrast = 0;
    double tall = 0;

    bool strong() const {
        return (sectors >= NearlyAllSectors && tall > Tall) ||
               (sectors >= ManySectors && contrast >= OtherColour);
    }
};

Evidence evidence_at(const VoxelGrid& grid, const VoxelSet& set, int z, int highest) {
    constexpr std::size_t least_section = 4;  // voxels
    constexpr double around = 5;              // voxels: the flat's colour is taken so near to the section
    const Mask section = section_above(grid, set, z);
    const auto area = section.count();
    if (area < least_section) return {};
    Mask flat = grid.columns(set, z - 1, z + 2);
    for (std::size_t i = 0; i < flat.data.size(); ++i) flat.data[i] &= section.data[i] == 0 ? 1 : 0;
    Evidence evidence;
    evidence.sectors = sectors_reached(section, flat);
    if (evidence.sectors < SomeSectors) return evidence;
    Mask near = dilate(section, around);
    for (std::size_t i = 0; i < near.data.size(); ++i) near.data[i] &= flat.data[i];
    evidence.contrast = contrast(colours_of(grid, set, z - 1, z + 2, &near),
                                 colours_of(grid, set, above(z), above(z) + Window, &section));
    evidence.tall = (highest - z) / std::sqrt(static_cast<double>(area));
    return evidence;
}

/// Members of each layer, and their number up to it.
struct Heights {
    std::vector<std::size_t> up_to;
    int lowest = 0, highest = -1;  // layers with members
    double share_above(int z) const {
        const auto place = static_cast<std::size_t>(std::clamp(z, 0, static_cast<int>(up_to.size()) - 1));
        return 1 - static_cast<double>(up_to[place]) /
                       static_cast<double>(std::max<std::size_t>(1, up_to.back()));
    }
};

Heights heights_of(const VoxelGrid& grid, const VoxelSet& set) {
    Heights heights;
    std::size_t sum = 0;
    for (int z = 0; z < grid.dimensions()[2]; ++z) {
        const auto before = sum;
        for (const auto voxel : grid.layer(z)) sum += set[voxel];
        heights.up_to.push_back(sum);
        if (sum == before) continue;
        if (heights.highest < 0) heights.lowest = z;
        heights.highest = z;
    }
    return heights;
}

/// Density of colours, by a smoothed histogram.
class ColourDensity {
public:
    explicit ColourDensity(const std::vector<Colour>& colours) : bins_(Bins * Bins * Bins, 0.0) {
        constexpr double side = 0.23;  // share of a bin that goes to each neighbour along an axis
        for (const auto& colour : colours) {
            const auto bin = bins_of(colour);
            for (int i = 0; i < 27; ++i) {
                const std::array<int, 3> step{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
                double share = 1;
                std::array<int, 3> at{};
                for (std::size_t c = 0; c < 3; ++c) {
                    share *= step[c] == 0 ? 1 - 2 * side : side;
                    at[c] = std::clamp(bin[c] + step[c], 0, Bins - 1);
                }
                bins_[index(at)] += share / static_cast<double>(colours.size());
            }
        }
    }
    double of(const Colour& colour) const {
        constexpr double any = 0.02;  // share of colours that were not seen
        return (1 - any) * bins_[index(bins_of(colour))] + any / static_cast<double>(bins_.size());
    }

private:
    static constexpr int Bins = 14;  // of a channel
    static std::array<int, 3> bins_of(const Colour& colour) {
        std::array<int, 3> bin{};
        for (std::size_t c = 0; c < 3; ++c)
            bin[c] = std::clamp(static_cast<int>(colour[c] * Bins), 0, Bins - 1);
        return bin;
    }
    static std::size_t index(const std::array<int, 3>& bin) {
        return static_cast<std::size_t>((bin[0] * Bins + bin[1]) * Bins + bin[2]);
    }
    std::vector<double> bins_;
};

/// Log odds of a voxel between two layers to stand on the support, from its own colour and place.
std::vector<double> log_odds(const VoxelGrid& grid, const VoxelSet& set, int low, int high) {
    constexpr int context = 12;  // layers beyond the band whose colours are known
    constexpr double most = 3, inside = 1, outside = -4, height = 2, certain = 6;  // nats
    constexpr std::size_t few = 5;
    constexpr std::size_t flat_weight = 3;  // of the flat's colours among those of the support
    const Mask section = dilate(closed(grid.columns(set, high + 1, high + 1 + Window)), 2);
    const auto upper = colours_of(grid, set, high + 1, high + 1 + context, nullptr);
    auto lower = colours_of(grid, set, low - context, low, nullptr);
    Mask beside = section;
    for (auto& value : beside.data) value = value == 0 ? 1 : 0;
    const auto flat = colours_of(grid, set, low, high + 1, &beside);
    for (std::size_t i = 0; i < flat_weight; ++i) lower.insert(lower.end(), flat.begin(), flat.end());
    const bool told = upper.size() >= few && lower.size() >= few;
    const ColourDensity standing(upper), support(lower);
    std::vector<double> odds(set.size(), 0);
    for (std::size_t voxel = 0; voxel < set.size(); ++voxel) {
        if (set[voxel] == 0) continue;
        const auto& place = grid.place(voxel);
        if (place[2] < low || place[2] > high || !told) {
            odds[voxel] = place[2] < low ? -certain : certain;
            continue;
        }
        const auto& colour = grid.colour(voxel);
        odds[voxel] = std::clamp(std::log(standing.of(colour) / support.of(colour)), -most, most) +
                      (section.at(place[0], place[1]) != 0 ? inside : outside) +
                      height * (static_cast<double>(place[2] - low) / std::max(1, high - low) - 0.5);
    }
    return odds;
}

}  // namespace

Mask section_above(const VoxelGrid& grid, const VoxelSet& set, int z) {
    return closed(grid.columns(set, above(z), above(z) + Window));
}

std::vector<SupportLayers> support_layers(const VoxelGrid& grid, const VoxelSet& set) {
    const auto heights = heights_of(grid, set);
    std::vector<SupportLayers> supports;
    SupportLayers run;
    bool open = false, strong = false;
    const auto close = [&] {
        if (open && strong) supports.push_back(run);
        open = strong = false;
    };
    for (int z = heights.lowest; z < heights.highest; ++z) {
        const double share = heights.share_above(z + 1);
        if (share < LeastShare || share > 1 - LeastShare) continue;
        const auto evidence = evidence_at(grid, set, z, heights.highest);
        if (evidence.sectors < SomeSectors) continue;
        if (open && z - run.last > RunGap) close();
        if (!open) run = {z, z, z}, open = true;
        run.last = z;
        if (evidence.strong()) run.top = z, strong = true;
    }
    close();
    for (auto& support : supports) support.last = std::min(support.last, support.top + Window);
    return supports;
}

VoxelSet split_at(const VoxelGrid& grid, const VoxelSet& set, int low, int high, bool upper) {
    constexpr int rounds = 15;
    constexpr double pull = 0.25;  // nats of a neighbour
    const auto odds = log_odds(grid, set, low, high);
    // Mean field of a grid with equal pulls: each voxel's belief from -1 to 1.
    std::vector<double> belief(set.size(), 0), next;
    for (std::size_t voxel = 0; voxel < set.size(); ++voxel)
        if (set[voxel] != 0) belief[voxel] = std::tanh(odds[voxel] / 2);
    for (int round = 0; round < rounds; ++round) {
        next = belief;
        for (int z = std::max(0, low); z <= std::min(high, grid.dimensions()[2] - 1); ++z)
            for (const auto voxel : grid.layer(z)) {
                if (set[voxel] == 0) continue;
                const auto& place = grid.place(voxel);
                double sum = -belief[voxel];
                for (int i = 0; i < 27; ++i) {
                    const int other =
                        grid.at(place[0] + i % 3 - 1, place[1] + i / 3 % 3 - 1, place[2] + i / 9 - 1);
                    if (other >= 0) sum += belief[static_cast<std::size_t>(other)];
                }
                next[voxel] = std::tanh((odds[voxel] + pull * sum) / 2);
            }
        belief.swap(next);
    }
    VoxelSet result(set.size(), 0);
    for (std::size_t voxel = 0; voxel < set.size(); ++voxel)
        result[voxel] = set[voxel] != 0 && (belief[voxel] > 0) == upper ? 1 : 0;
    return result;
}

std::vector<int> thin_layers(const VoxelGrid& grid, const VoxelSet& set) {
    constexpr double thin = 0.13, least_share = 0.05;  // of the wider sections; of the members on either side
    constexpr int near = 3;
    const auto heights = heights_of(grid, set);
    if (heights.highest < 0) return {};
    std::vector<std::size_t> areas;
    for (int z = 0; z <= heights.highest; ++z) {
        const bool any = heights.up_to[static_cast<std::size_t>(z)] >
                         (z > 0 ? heights.up_to[static_cast<std::size_t>(z) - 1] : 0);
        areas.push_back(any ? closed(grid.columns(set, z - 1, z + 2)).count() : 0);
    }
    std::vector<int> layers;
    for (int z = heights.lowest + near; z + near < heights.highest; ++z) {
        const auto at = areas.begin() + z;
        const auto wider =
            std::min(*std::max_element(areas.begin(), at + 1), *std::max_element(at, areas.end()));
        const double share = heights.share_above(z);
        if (static_cast<double>(*at) >= thin * static_cast<double>(wider) || share < least_share ||
            share > 1 - least_share || *at != *std::min_element(at - near, at + near + 1))
            continue;
        if (contrast(colours_of(grid, set, z + 1, z + 1 + Window, nullptr),
                     colours_of(grid, set, z - Window, z, nullptr)) >= OtherColour)
            layers.push_back(z);
    }
    return layers;
}

}  // namespace gse::localize
