// Minimum cuts (OpenCV's graph) between balls around the seed and what lies farther off.
#include "engine/localize/linked_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#ifdef GSE_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#endif

namespace gse::localize {

#ifdef GSE_HAVE_OPENCV

namespace {

// Radii of the inner balls, of the thing's own radius; the outer one has three times as much.
constexpr std::array<double, 8> InnerRadii{0.03, 0.045, 0.065, 0.095, 0.14, 0.2, 0.28, 0.38};
constexpr double OuterRadius = 3, LeastInnerRadius = 1.5;  // inner radii; voxels
constexpr double ThingRadius = 0.95;                       // share of the members within a thing's radius
constexpr std::size_t LeastVoxels = 100;                   // of a thing that has parts
constexpr double SmallestPart = 0.01, LargestPart = 0.6;   // of the thing
constexpr double ClearCost = 2;  // of a border per root of a part's voxels; one colour alone costs 5 to 8
constexpr double StableGrowth = 1.5;  // of a part, from one radius to the next
constexpr std::size_t Neighbours = 10;
constexpr int FarthestNeighbour = 6;  // voxels
constexpr double LeastEdge = 0.02;    // cost of an edge between opposite colours
constexpr double ColourPull = 0.15;   // of a member's log odds, against the cost 1 of an edge
constexpr double MostOdds = 3, RareColour = 1e-4;
constexpr int Levels = 6;  // of a channel, in a histogram

using Colour = std::array<float, 3>;

struct Edge {
    int from = 0, to = 0;
    double length = 1;  // voxels
    double difference = 0, cost = 0;
};

/// Members of a thing with edges between neighbours.
struct PartGraph {
    std::vector<std::size_t> voxels;
    std::vector<double> distances;  // from the seed, voxels
    std::vector<std::size_t> bins;  // of their colours in a histogram
    std::vector<Edge> edges;
    double radius = 0;  // voxels
};

double squared_difference(const Colour& a, const Colour& b) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += std::pow(static_cast<double>(a[c]) - b[c], 2.0);
    return sum;
}

/// Mean colours of the members and those beside them: voxels of scans are noisy.
std::vector<Colour> smoothed_colours(const VoxelGrid& grid, const VoxelSet& thing) {
    std::vector<Colour> colours(grid.size());
    for (std::size_t voxel = 0; voxel < grid.size(); ++voxel) {
        if (thing[voxel] == 0) continue;
        const auto& at = grid.place(voxel);
        std::array<double, 3> sum{};
        double count = 0;
        for (int i = 0; i < 27; ++i) {
            const int other = grid.at(at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1);
            if (other < 0 || thing[static_cast<std::size_t>(other)] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += grid.colour(static_cast<std::size_t>(other))[c];
            count += 1;
        }
        for (std::size_t c = 0; c < 3; ++c) colours[voxel][c] = static_cast<float>(sum[c] / count);
    }
    return colours;
}

std::size_t bin_of(const Colour& colour) {
    int bin = 0;
    for (const float value : colour)
        bin = bin * Levels + std::clamp(static_cast<int>(value * Levels), 0, Levels - 1);
    return static_cast<std::size_t>(bin);
}

/// Squared distance in voxels, and index, of the members nearest to a place. Surfaces of sparse scans have
/// gaps, and the nearest may lie beyond one.
std::vector<std::pair<int, std::size_t>> nearest_members(const VoxelGrid& grid, const VoxelSet& thing,
                                                         const VoxelGrid::Place& at) {
    std::vector<std::pair<int, std::size_t>> found;
    for (int shell = 1; shell <= FarthestNeighbour && found.size() < Neighbours; ++shell)
        for (int dz = -shell; dz <= shell; ++dz)
            for (int dy = -shell; dy <= shell; ++dy)
                for (int dx = -shell; dx <= shell; ++dx) {
                    if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) != shell) continue;
                    const int other = grid.at(at[0] + dx, at[1] + dy, at[2] + dz);
                    if (other >= 0 && thing[static_cast<std::size_t>(other)] != 0)
                        found.emplace_back(dx * dx + dy * dy + dz * dz, static_cast<std::size_t>(other));
                }
    std::sort(found.begin(), found.end());
    if (found.size() > Neighbours) found.resize(Neighbours);
    return found;
}

/// Drops the second of two edges between the same members.
void drop_doubles(std::vector<Edge>& edges) {
    const auto ends = [](const Edge& edge) { return std::pair(edge.from, edge.to); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
    const auto same = [&](const Edge& a, const Edge& b) { return ends(a) == ends(b); };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
}

/// Costs of cutting edges: less between unlike colours and over gaps (Boykov and Jolly 2001).
void set_costs(std::vector<Edge>& edges) {
    constexpr double LeastMean = 1e-5;  // things of one colour
    double mean = 0;
    for (const auto& edge : edges) mean += edge.difference / static_cast<double>(edges.size());
    for (auto& edge : edges)
        edge.cost = (LeastEdge + std::exp(-edge.difference / (2 * std::max(mean, LeastMean)))) / edge.length;
}

PartGraph graph_of(const VoxelGrid& grid, const VoxelSet& thing, const VoxelGrid::Place& seed) {
    PartGraph graph;
    std::vector<int> number(grid.size(), -1);
    for (std::size_t voxel = 0; voxel < grid.size(); ++voxel)
        if (thing[voxel] != 0) {
            number[voxel] = static_cast<int>(graph.voxels.size());
            graph.voxels.push_back(voxel);
        }
    if (graph.voxels.size() < LeastVoxels) return graph;
    const auto colours = smoothed_colours(grid, thing);
    for (const auto voxel : graph.voxels) {
        const auto& at = grid.place(voxel);
        graph.distances.push_back(std::hypot(at[0] - seed[0], at[1] - seed[1], at[2] - seed[2]));
        graph.bins.push_back(bin_of(colours[voxel]));
        for (const auto& [squared, other] : nearest_members(grid, thing, at))
            graph.edges.push_back({std::min(number[voxel], number[other]),
                                   std::max(number[voxel], number[other]),
                                   std::sqrt(static_cast<double>(squared)),
                                   squared_difference(colours[voxel], colours[other])});
    }
    drop_doubles(graph.edges);
    set_costs(graph.edges);
    auto sorted = graph.distances;
    std::sort(sorted.begin(), sorted.end());
    graph.radius = sorted[static_cast<std::size_t>(ThingRadius * static_cast<double>(sorted.size() - 1))];
    return graph;
}

/// Counts of a histogram, each with half of those beside it.
std::vector<double> smoothed(const std::vector<double>& counts) {
    const auto at = [&](int r, int g, int b) {
        const bool in = std::min({r, g, b}) >= 0 && std::max({r, g, b}) < Levels;
        return in ? counts[static_cast<std::size_t>((r * Levels + g) * Levels + b)] : 0.0;
    };
    auto result = counts;
    for (int i = 0; i < static_cast<int>(counts.size()); ++i) {
        const int r = i / Levels / Levels, g = i / Levels % Levels, b = i % Levels;
        result[static_cast<std::size_t>(i)] += 0.5 * (at(r - 1, g, b) + at(r + 1, g, b) + at(r, g - 1, b) +
                                                      at(r, g + 1, b) + at(r, g, b - 1) + at(r, g, b + 1));
    }
    return result;
}

/// Log odds of each member's colour within the inner ball against the whole thing.
std::vector<double> colour_odds(const PartGraph& graph, double inner) {
    std::vector<double> near(Levels * Levels * Levels, 0), all = near;
    double nears = 0;
    for (std::size_t i = 0; i < graph.bins.size(); ++i) {
        all[graph.bins[i]] += 1;
        if (graph.distances[i] <= inner) near[graph.bins[i]] += 1, nears += 1;
    }
    near = smoothed(near), all = smoothed(all);
    const double count = static_cast<double>(graph.bins.size());
    std::vector<double> odds;
    for (const auto bin : graph.bins) {
        const double here = near[bin] / std::max(nears, 1.0) + RareColour, there = all[bin] / count;
        odds.push_back(std::clamp(std::log(here / (there + RareColour)), -MostOdds, MostOdds));
    }
    return odds;
}

/// Members on the seed's side of a minimum cut.
struct Cut {
    std::vector<std::uint8_t> inside;
    std::size_t count = 0;
    double cost = std::numeric_limits<double>::infinity();  // of the border, per root of the smaller side

    bool is_part(double all) const {
        const auto size = static_cast<double>(count);
        return size >= SmallestPart * all && size <= LargestPart * all && cost < ClearCost;
    }
};

Cut cut_between(const PartGraph& graph, double inner) {
    constexpr double Certain = 1e6;
    cv::detail::GCGraph<double> flow(static_cast<unsigned>(graph.voxels.size()),
                                     static_cast<unsigned>(2 * graph.edges.size()));
    const auto odds = colour_odds(graph, inner);
    for (std::size_t i = 0; i < graph.distances.size(); ++i) {
        const double distance = graph.distances[i], pull = ColourPull * odds[i];
        flow.addTermWeights(flow.addVtx(), distance <= inner ? Certain : std::max(0.0, pull),
                            distance >= OuterRadius * inner ? Certain : std::max(0.0, -pull));
    }
    for (const auto& edge : graph.edges) flow.addEdges(edge.from, edge.to, edge.cost, edge.cost);
    flow.maxFlow();
    Cut cut;
    for (int i = 0; i < static_cast<int>(graph.voxels.size()); ++i) {
        cut.inside.push_back(flow.inSourceSegment(i) ? 1 : 0);
        cut.count += cut.inside.back();
    }
    double border = 0;
    for (const auto& edge : graph.edges)
        if (cut.inside[static_cast<std::size_t>(edge.from)] != cut.inside[static_cast<std::size_t>(edge.to)])
            border += edge.cost;
    const std::size_t smaller = std::min(cut.count, graph.voxels.size() - cut.count);
    if (smaller > 0) cut.cost = border / std::sqrt(static_cast<double>(smaller));
    return cut;
}

}  // namespace

VoxelSet linked_part(const VoxelGrid& grid, const VoxelSet& thing, const VoxelGrid::Place& seed) {
    const auto graph = graph_of(grid, thing, seed);
    const auto all = static_cast<double>(graph.voxels.size());
    if (graph.edges.empty()) return {};
    Cut before;
    for (const double share : InnerRadii) {
        auto cut = cut_between(graph, std::max(share * graph.radius, LeastInnerRadius));
        if (before.is_part(all) &&
            static_cast<double>(cut.count) <= StableGrowth * static_cast<double>(before.count)) {
            VoxelSet part(grid.size(), 0);
            for (std::size_t i = 0; i < graph.voxels.size(); ++i) part[graph.voxels[i]] = before.inside[i];
            return part;
        }
        before = std::move(cut);
    }
    return {};
}

#else

VoxelSet linked_part(const VoxelGrid&, const VoxelSet&, const VoxelGrid::Place&) { return {}; }

#endif

}  // namespace gse::localize
