// Cells by opacity, linked over small gaps.
#include "engine/localize/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "engine/math/sh.h"

namespace gse::localize {
namespace {

constexpr double LeastOpacity = 0.1;  // of a Gaussian that fills a voxel
constexpr double LeastFilled = 0.3;   // sum of the opacities in a solid voxel
constexpr int Margin = 4;             // empty cells around the solid ones

double opacity_of(const GaussianSpans& gaussians, std::size_t row) {
    return 1 / (1 + std::exp(-static_cast<double>(gaussians.opacity_logit[row])));
}

/// Sums over the Gaussians of a cell.
struct Filled {
    double weight = 0;
    std::array<double, 3> colour{};
};

std::uint64_t key_of(const VoxelGrid::Place& at) {
    constexpr std::uint64_t bits = 21, bias = std::uint64_t{1} << (bits - 1);
    std::uint64_t key = 0;
    for (const int value : at) key = key << bits | (static_cast<std::uint64_t>(value) + bias);
    return key;
}

VoxelGrid::Place place_of_key(std::uint64_t key) {
    constexpr std::uint64_t bits = 21, mask = (std::uint64_t{1} << bits) - 1;
    constexpr int bias = 1 << (bits - 1);
    VoxelGrid::Place at{};
    for (std::size_t axis = 3; axis-- > 0; key >>= bits) at[axis] = static_cast<int>(key & mask) - bias;
    return at;
}

Filled& add(Filled& sum, const GaussianSpans& gaussians, std::size_t row, double opacity) {
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
    sum.weight += opacity;
    for (std::size_t c = 0; c < 3; ++c)
        sum.colour[c] +=
            opacity *
            std::clamp(colour_from_sh(static_cast<double>(gaussians.sh[row * stride + c])), 0.0, 1.0);
    return sum;
}

}  // namespace

VoxelGrid::VoxelGrid(const GaussianSpans& gaussians, const GridFrame& frame) : frame_(frame) {
    const Vec3 up = normalized(frame.up);
    const Vec3 level = normalized(cross(up, std::abs(up[0]) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}));
    axes_ = {level, cross(up, level), up};
    std::unordered_map<std::uint64_t, Filled> filled;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        const double opacity = opacity_of(gaussians, row);
        Vec3 at;
        if (!(opacity > LeastOpacity) || !reached(gaussians, row, at)) continue;
        float largest = -std::numeric_limits<float>::infinity();
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest = std::max(largest, gaussians.log_scale[row * 3 + axis]);
        if (!(std::exp(static_cast<double>(largest)) < frame.largest_scale)) continue;
        add(filled[key_of({static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])})],
            gaussians, row, opacity);
    }
    std::vector<std::pair<std::uint64_t, Filled>> solid;
    for (const auto& entry : filled)
        if (entry.second.weight > LeastFilled) solid.push_back(entry);
    std::sort(solid.begin(), solid.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    Place low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::numeric_limits<int>::max(), high[axis] = std::numeric_limits<int>::min();
        for (const auto& [key, sum] : solid) {
            low[axis] = std::min(low[axis], place_of_key(key)[axis]);
            high[axis] = std::max(high[axis], place_of_key(key)[axis]);
        }
        offset_[axis] = solid.empty() ? 0 : low[axis] - Margin;
        dimensions_[axis] = solid.empty() ? 0 : high[axis] - low[axis] + 1 + 2 * Margin;
    }
    index_.assign(cell(0, 0, dimensions_[2]), -1);
    layers_.resize(static_cast<std::size_t>(dimensions_[2]));
    for (const auto& [key, sum] : solid) {
        Place at = place_of_key(key);
        for (std::size_t axis = 0; axis < 3; ++axis) at[axis] -= offset_[axis];
        const auto voxel = static_cast<std::uint32_t>(places_.size());
        index_[cell(at[0], at[1], at[2])] = static_cast<int>(voxel);
        layers_[static_cast<std::size_t>(at[2])].push_back(voxel);
        places_.push_back(at);
        colours_.push_back({});
        for (std::size_t c = 0; c < 3; ++c)
            colours_.back()[c] = static_cast<float>(sum.colour[c] / sum.weight);
    }
}

/// Place of the row in cells before the offset is taken off; false outside of the reach.
bool VoxelGrid::reached(const GaussianSpans& gaussians, std::size_t row, Vec3& place) const {
    const auto* at = &gaussians.position[row * 3];
    const Vec3 from = Vec3{at[0], at[1], at[2]} - frame_.centre;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = dot(from, axes_[static_cast<std::size_t>(axis)]);
        if (!(std::abs(along) < frame_.reach)) return false;
        place[axis] = std::floor(along / frame_.side);
    }
    return true;
}

std::size_t VoxelGrid::cell(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(dimensions_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(dimensions_[0]) +
           static_cast<std::size_t>(x);
}

bool VoxelGrid::within(const Place& place) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (place[axis] < 0 || place[axis] >= dimensions_[axis]) return false;
    return true;
}

int VoxelGrid::at(int x, int y, int z) const { return within({x, y, z}) ? index_[cell(x, y, z)] : -1; }

VoxelGrid::Place VoxelGrid::place_of(const Vec3& point) const {
    Place place{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        place[axis] = static_cast<int>(std::floor(dot(point - frame_.centre, axes_[axis]) / frame_.side)) -
                      offset_[axis];
    return place;
}

Vec3 VoxelGrid::centre_of(const Place& place) const {
    Vec3 point = frame_.centre;
    for (std::size_t axis = 0; axis < 3; ++axis)
        point += axes_[axis] * ((place[axis] + offset_[axis] + 0.5) * frame_.side);
    return point;
}

VoxelSet VoxelGrid::connected(const VoxelSet& among, const Place& seed) const {
    VoxelSet found(size(), 0);
    std::size_t nearest = size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t voxel = 0; voxel < size(); ++voxel) {
        if (among[voxel] == 0) continue;
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            squared += std::pow(places_[voxel][axis] - seed[axis], 2.0);
        if (squared < least) least = squared, nearest = voxel;
    }
    if (nearest == size()) return found;
    // Blocks of voxels stand for their members: neighbouring blocks with members are linked.
    const int side = std::max(1, frame_.link);
    Place blocks{};
    for (std::size_t axis = 0; axis < 3; ++axis) blocks[axis] = dimensions_[axis] / side + 1;
    const auto block = [&](int x, int y, int z) {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(blocks[0]) +
               static_cast<std::size_t>(x);
    };
    const auto block_of = [&](const Place& at) { return Place{at[0] / side, at[1] / side, at[2] / side}; };
    enum : std::uint8_t { Empty, Waiting, Reached };
    std::vector<std::uint8_t> states(block(0, 0, blocks[2]), Empty);
    for (std::size_t voxel = 0; voxel < size(); ++voxel)
        if (among[voxel] != 0) {
            const auto at = block_of(places_[voxel]);
            states[block(at[0], at[1], at[2])] = Waiting;
        }
    std::vector<Place> open{block_of(places_[nearest])};
    states[block(open[0][0], open[0][1], open[0][2])] = Reached;
    while (!open.empty()) {
        const Place at = open.back();
        open.pop_back();
        for (int z = std::max(0, at[2] - 1); z <= std::min(blocks[2] - 1, at[2] + 1); ++z)
            for (int y = std::max(0, at[1] - 1); y <= std::min(blocks[1] - 1, at[1] + 1); ++y)
                for (int x = std::max(0, at[0] - 1); x <= std::min(blocks[0] - 1, at[0] + 1); ++x) {
                    auto& state = states[block(x, y, z)];
                    if (state != Waiting) continue;
                    state = Reached;
                    open.push_back({x, y, z});
                }
    }
    for (std::size_t voxel = 0; voxel < size(); ++voxel) {
        const auto at = block_of(places_[voxel]);
        if (among[voxel] != 0 && states[block(at[0], at[1], at[2])] == Reached) found[voxel] = 1;
    }
    return found;
}

Mask VoxelGrid::columns(const VoxelSet& set, int low, int high) const {
    Mask mask(dimensions_[0], dimensions_[1]);
    for (int z = std::max(0, low); z < std::min(high, dimensions_[2]); ++z)
        for (const auto voxel : layer(z))
            if (set[voxel] != 0) mask.at(places_[voxel][0], places_[voxel][1]) = 1;
    return mask;
}

std::vector<std::uint8_t> VoxelGrid::rows(const GaussianSpans& gaussians, const VoxelSet& set) const {
    enum : std::uint8_t { Empty, Other, Member };
    std::vector<std::uint8_t> owner(index_.size(), Empty);
    for (std::size_t voxel = 0; voxel < size(); ++voxel) {
        const auto& at = places_[voxel];
        owner[cell(at[0], at[1], at[2])] = set[voxel] != 0 ? Member : Other;
    }
    std::vector<Place> edge = places_, next;
    for (int step = 0; step < Margin; ++step, edge.swap(next)) {
        next.clear();
        for (const auto& at : edge)
            for (const auto& [x, y, z] : {Place{at[0] - 1, at[1], at[2]}, Place{at[0] + 1, at[1], at[2]},
                                          Place{at[0], at[1] - 1, at[2]}, Place{at[0], at[1] + 1, at[2]},
                                          Place{at[0], at[1], at[2] - 1}, Place{at[0], at[1], at[2] + 1}}) {
                if (!within({x, y, z}) || owner[cell(x, y, z)] != Empty) continue;
                owner[cell(x, y, z)] = owner[cell(at[0], at[1], at[2])];
                next.push_back({x, y, z});
            }
    }
    std::vector<std::uint8_t> result(gaussians.size, 0);
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        Vec3 at;
        if (!reached(gaussians, row, at)) continue;
        const Place place{static_cast<int>(at[0]) - offset_[0], static_cast<int>(at[1]) - offset_[1],
                          static_cast<int>(at[2]) - offset_[2]};
        result[row] = within(place) && owner[cell(place[0], place[1], place[2])] == Member ? 1 : 0;
    }
    return result;
}

std::vector<std::uint8_t> VoxelGrid::all_rows(const GaussianSpans& gaussians) const {
    std::vector<std::uint8_t> result(gaussians.size, 0);
    Vec3 at;
    for (std::size_t row = 0; row < gaussians.size; ++row) result[row] = reached(gaussians, row, at) ? 1 : 0;
    return result;
}

}  // namespace gse::localize
