// Linked voxels, without supports.
#include "engine/localize/grow_thing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "engine/localize/linked_part.h"
#include "engine/localize/support_layers.h"

namespace gse::localize {
namespace {

constexpr double VoxelsPerPicture = 125;  // in its height
// Sizes at which the thing is looked at: its rows are those of most of them.
constexpr std::array<double, 7> VoxelSizes{0.85, 0.95, 1.05, 1.2, 1.35, 1.5, 1.7};
constexpr double Gap = 0.022;          // of the height: wider gaps part two things
constexpr double Reach = 1.6;          // heights of the picture, from the seed
constexpr int SurfaceNeighbours = 10;  // of 26: a surface has more, a crumb in a hollow thing has fewer
constexpr double Giant = 0.15;         // of the height: larger Gaussians are sky or haze
constexpr double NearlyAll = 0.97;     // of the voxels: then everything is the thing

VoxelGrid grid_around(const GaussianSpans& gaussians, const GrowRequest& request) {
    GridFrame frame;
    frame.centre = request.seed, frame.up = request.up;
    frame.side = request.voxel_size * request.extent / VoxelsPerPicture;
    frame.link = static_cast<int>(std::lround(Gap * request.extent / frame.side));
    frame.reach = Reach * request.extent;
    frame.largest_scale = Giant * request.extent;
    return {gaussians, frame};
}

VoxelSet within_layers(const VoxelGrid& grid, const VoxelSet& set, int low, int high) {
    VoxelSet result(set.size(), 0);
    for (int z = std::max(0, low); z < std::min(high, grid.dimensions()[2]); ++z)
        for (const auto voxel : grid.layer(z)) result[voxel] = set[voxel];
    return result;
}

VoxelSet without(VoxelSet set, const VoxelSet& taken) {
    for (std::size_t voxel = 0; voxel < set.size(); ++voxel)
        set[voxel] = set[voxel] != 0 && taken[voxel] == 0 ? 1 : 0;
    return set;
}

/// Least-squares plane z = a x + b y + c through the members; those far from it are left out in turns.
class Plane {
public:
    Plane(const VoxelGrid& grid, const VoxelSet& set) {
        constexpr int rounds = 5;
        constexpr double near = 1.5;  // voxels
        for (int round = 0; round < rounds; ++round) {
            Mat3 normal;
            Vec3 right;
            for (std::size_t voxel = 0; voxel < set.size(); ++voxel) {
                const auto& at = grid.place(voxel);
                if (set[voxel] == 0 || (round > 0 && std::abs(distance(at)) > near)) continue;
                const Vec3 x{1.0 * at[0], 1.0 * at[1], 1};
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j) normal(i, j) += x[i] * x[j];
                right += x * static_cast<double>(at[2]);
            }
            if (std::abs(glm::determinant(normal.columns)) < 1e-6) return;
            values_ = Mat3(glm::inverse(normal.columns)) * right;
        }
    }
    /// Layers above the plane.
    double distance(const VoxelGrid::Place& at) const {
        return at[2] - (values_[0] * at[0] + values_[1] * at[1] + values_[2]);
    }

private:
    Vec3 values_{};
};

/// The flat through the seed, which may be tilted a little.
VoxelSet ground_at(const VoxelGrid& grid, const VoxelSet& set, const VoxelGrid::Place& seed) {
    constexpr int band = 3;      // layers on either side that the plane is read from
    constexpr double thick = 2;  // voxels
    const auto flat = grid.connected(within_layers(grid, set, seed[2] - band, seed[2] + band), seed);
    const Plane plane(grid, flat);
    VoxelSet result(set.size(), 0);
    for (std::size_t voxel = 0; voxel < set.size(); ++voxel)
        result[voxel] = set[voxel] != 0 && plane.distance(grid.place(voxel)) < thick ? 1 : 0;
    return grid.connected(result, seed);
}

/// Tells whether the seed lies on the support's flat, beside what stands there.
bool on_flat(const VoxelGrid& grid, const VoxelSet& set, const SupportLayers& support,
             const VoxelGrid::Place& seed) {
    if (seed[2] < support.first - 1 || seed[2] > support.top + 1) return false;
    return section_above(grid, set, support.top).at(seed[0], seed[1]) == 0;
}

int highest_undecided(const SupportLayers& support) { return std::max(support.last, support.top + 1) + 2; }

/// A thing in its making.
class Growth {
public:
    Growth(const VoxelGrid& grid, const VoxelGrid::Place& seed, VoxelSet set)
        : grid_(grid), seed_(seed), set_(std::move(set)) {}

    void cut_threads() {
        for (const int z : thin_layers(grid_, set_)) {
            if (std::abs(seed_[2] - z) <= 1) continue;
            const bool above = seed_[2] > z;
            keep(within_layers(grid_, set_, above ? z : 0, above ? grid_.dimensions()[2] : z + 1));
            thing.from_thread = true;
            return;
        }
    }
    void cut_supports() {
        const auto supports = support_layers(grid_, set_);
        const VoxelSet whole = set_;
        const SupportLayers *below = nullptr, *above = nullptr;
        for (const auto& support : supports) {
            const bool flat = on_flat(grid_, whole, support, seed_);
            if (support.top < seed_[2] && !flat) below = &support;
            else if (above == nullptr && (flat || support.last >= seed_[2] - 1)) above = &support;
        }
        if (below != nullptr) {
            const int high = std::min(highest_undecided(*below), seed_[2] - 1);
            keep(split_at(grid_, whole, below->first - 1, high, true));
            thing.from_support = true;
        }
        if (above == nullptr) return;
        keep(without(set_, split_at(grid_, set_, above->first - 1, highest_undecided(*above), true)));
        thing.from_above = true;
    }
    void cut_part() {
        if (thing.from_above || thing.from_thread) return;  // it is parted already
        const auto part = linked_part(grid_, set_, seed_);
        if (part.empty()) return;
        keep(part);
        thing.from_whole = true;
    }
    void keep_ground() { keep(ground_at(grid_, set_, seed_)); }
    const VoxelSet& set() const { return set_; }

    GrownThing thing;

private:
    void keep(const VoxelSet& set) { set_ = grid_.connected(set, seed_); }

    const VoxelGrid& grid_;
    VoxelGrid::Place seed_;
    VoxelSet set_;
};

/// Members around a voxel, at most 26.
int neighbours_of(const VoxelGrid& grid, const VoxelSet& set, std::size_t voxel) {
    const auto& place = grid.place(voxel);
    int count = -1;  // the voxel itself
    for (int i = 0; i < 27; ++i) {
        const int other = grid.at(place[0] + i % 3 - 1, place[1] + i / 3 % 3 - 1, place[2] + i / 9 - 1);
        if (other >= 0) count += set[static_cast<std::size_t>(other)];
    }
    return count;
}

/// The thing as voxels of one size show it.
GrownThing grown_at(const GaussianSpans& gaussians, const GrowRequest& request) {
    const auto grid = grid_around(gaussians, request);
    if (grid.size() == 0) return {std::vector<std::uint8_t>(gaussians.size, 0)};
    const auto seed = grid.place_of(request.seed);
    Growth growth(grid, seed, grid.connected(VoxelSet(grid.size(), 1), seed));
    if (request.ground) growth.keep_ground();
    else growth.cut_threads(), growth.cut_supports();
    if (request.part) growth.cut_part();
    auto thing = std::move(growth.thing);
    const auto count = std::count(growth.set().begin(), growth.set().end(), std::uint8_t{1});
    thing.rows = static_cast<double>(count) >= NearlyAll * static_cast<double>(grid.size())
                     ? grid.all_rows(gaussians)
                     : grid.rows(gaussians, growth.set());
    return thing;
}

/// Centre of the member of a surface that is nearest to a place: the place may be empty, or hold a crumb.
std::optional<Vec3> seed_near(const VoxelGrid& grid, const VoxelSet& set, const VoxelGrid::Place& at) {
    std::optional<Vec3> seed;
    double least = 0;
    for (const int neighbours : {SurfaceNeighbours, 0}) {
        for (std::size_t voxel = 0; voxel < grid.size(); ++voxel) {
            if (set[voxel] == 0 || neighbours_of(grid, set, voxel) < neighbours) continue;
            const auto& place = grid.place(voxel);
            const double squared = std::pow(place[0] - at[0], 2.0) + std::pow(place[1] - at[1], 2.0) +
                                   std::pow(place[2] - at[2], 2.0);
            if (!seed || squared < least) seed = grid.centre_of(place), least = squared;
        }
        if (seed) break;
    }
    return seed;
}

/// Share of a layer's columns with nothing right above: all of a thing's underside lies below the thing.
double free_share(const VoxelGrid& grid, const VoxelSet& all, int layer) {
    constexpr double Above = 0.25;  // of the layers
    const auto flat = grid.columns(all, layer - 1, layer + 2);
    const auto above = grid.columns(all, layer + 3, layer + static_cast<int>(Above * grid.dimensions()[2]));
    double free = 0, count = 0;
    for (std::size_t i = 0; i < flat.data.size(); ++i)
        if (flat.data[i] != 0) count += 1, free += above.data[i] == 0 ? 1 : 0;
    return count > 0 ? free / count : 0;
}

/// Top of the lowest flat that is large against the largest one and the whole scene from above.
std::optional<int> ground_layer(const VoxelGrid& grid, const VoxelSet& all) {
    constexpr double OfLargest = 0.6, OfFootprint = 0.4, LeastFree = 0.25;
    constexpr int Thickness = 8;  // layers from the underside of a slab to its top
    const int layers = grid.dimensions()[2];
    std::vector<double> areas;
    for (int z = 0; z < layers; ++z)
        areas.push_back(static_cast<double>(grid.columns(all, z - 1, z + 2).count()));
    const auto footprint = static_cast<double>(grid.columns(all, 0, layers).count());
    const double most = areas.empty() ? 0 : *std::max_element(areas.begin(), areas.end());
    if (most < OfFootprint * footprint || most == 0) return std::nullopt;
    const auto large = [&](double area) { return area >= OfLargest * most; };
    const auto lowest = std::find_if(areas.begin(), areas.end(), large);
    const auto end = areas.end() - lowest > Thickness ? lowest + Thickness : areas.end();
    const auto top = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(lowest), large);
    const int layer = static_cast<int>(top.base() - areas.begin()) - 1;
    return free_share(grid, all, layer) >= LeastFree ? std::optional(layer) : std::nullopt;
}

}  // namespace

GrownThing grow_thing(const GaussianSpans& gaussians, const GrowRequest& request) {
    GrownThing thing;
    std::vector<int> votes(gaussians.size, 0);
    int support = 0, above = 0, thread = 0, whole = 0;
    for (const double size : VoxelSizes) {
        GrowRequest scaled = request;
        scaled.voxel_size = size;
        const auto one = grown_at(gaussians, scaled);
        for (std::size_t row = 0; row < votes.size(); ++row) votes[row] += one.rows[row];
        support += one.from_support, above += one.from_above, thread += one.from_thread;
        whole += one.from_whole;
    }
    const auto most = [](int count) { return 2 * count > static_cast<int>(VoxelSizes.size()); };
    thing.from_support = most(support), thing.from_above = most(above), thing.from_thread = most(thread);
    thing.from_whole = most(whole);
    for (const int count : votes) thing.rows.push_back(most(count) ? 1 : 0);
    return thing;
}

std::optional<Vec3> largest_thing(const GaussianSpans& gaussians, const Vec3& centre, double radius,
                                  const Vec3& up) {
    const auto grid = grid_around(gaussians, {centre, up, 2 * radius});
    if (grid.size() == 0) return std::nullopt;
    VoxelSet left(grid.size(), 1);
    const auto supports = support_layers(grid, left);
    if (!supports.empty())
        left = split_at(grid, left, supports.back().first - 1, highest_undecided(supports.back()), true);
    VoxelSet largest;
    std::ptrdiff_t most = 0;
    for (std::size_t voxel = 0; voxel < grid.size(); ++voxel) {
        if (left[voxel] == 0) continue;
        auto thing = grid.connected(left, grid.place(voxel));
        const auto count = std::count(thing.begin(), thing.end(), std::uint8_t{1});
        left = without(std::move(left), thing);
        if (count > most) most = count, largest = std::move(thing);
    }
    if (most == 0) return std::nullopt;
    Vec3 middle;
    for (std::size_t voxel = 0; voxel < grid.size(); ++voxel)
        if (largest[voxel] != 0) middle += grid.centre_of(grid.place(voxel)) / static_cast<double>(most);
    return seed_near(grid, largest, grid.place_of(middle));
}

std::optional<Vec3> ground_seed(const GaussianSpans& gaussians, const Vec3& centre, double radius,
                                const Vec3& up) {
    const auto grid = grid_around(gaussians, {centre, up, 2 * radius});
    const VoxelSet all(grid.size(), 1);
    const auto layer = ground_layer(grid, all);
    if (!layer) return std::nullopt;
    const auto flat = within_layers(grid, all, *layer - 1, *layer + 2);
    const auto count = static_cast<double>(std::count(flat.begin(), flat.end(), std::uint8_t{1}));
    Vec3 middle;
    for (std::size_t voxel = 0; voxel < grid.size(); ++voxel)
        if (flat[voxel] != 0) middle += grid.centre_of(grid.place(voxel)) / count;
    return seed_near(grid, flat, grid.place_of(middle));
}

}  // namespace gse::localize
