// Voxels of a part of a scene: solid ones with their colour, in a frame whose third axis is up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/scene/gaussian_set.h"

namespace gse::localize {

/// Byte per solid voxel of a grid: 1 for its members.
using VoxelSet = std::vector<std::uint8_t>;

/// Place of a grid in the world.
struct GridFrame {
    Vec3 centre{};
    Vec3 up{0, -1, 0};
    double side = 1;           // of a voxel, world units
    double reach = 1;          // from the centre along each axis, world units
    int link = 3;              // voxels: members that near to each other are linked
    double largest_scale = 1;  // world units: Gaussians of a larger standard deviation fill no voxel
};

/// Solid voxels and the Gaussians that fill them.
class VoxelGrid {
public:
    using Place = std::array<int, 3>;  // along two level axes and up

    VoxelGrid(const GaussianSpans& gaussians, const GridFrame& frame);

    /// Number of solid voxels.
    std::size_t size() const { return places_.size(); }
    const std::array<int, 3>& dimensions() const { return dimensions_; }
    const Place& place(std::size_t voxel) const { return places_[voxel]; }
    /// Mean colour in display values, weighted by opacity.
    const std::array<float, 3>& colour(std::size_t voxel) const { return colours_[voxel]; }
    /// Index of the solid voxel there; -1 = none.
    int at(int x, int y, int z) const;
    /// Solid voxels of one layer.
    const std::vector<std::uint32_t>& layer(int z) const { return layers_[static_cast<std::size_t>(z)]; }
    /// Place of a point of the world; it may lie outside.
    Place place_of(const Vec3& point) const;
    /// Centre of a voxel in the world.
    Vec3 centre_of(const Place& place) const;

    /// Members of `among` that are linked with the member nearest to `seed`. Gaps up to the frame's link
    /// are bridged, those of more than twice as much are not. Empty if `among` is.
    VoxelSet connected(const VoxelSet& among, const Place& seed) const;
    /// Columns with a member in the layers [low, high).
    Mask columns(const VoxelSet& set, int low, int high) const;
    /// Byte per Gaussian: 1 where the nearest solid voxel is a member. Gaussians farther than four voxels
    /// from a solid one have 0.
    std::vector<std::uint8_t> rows(const GaussianSpans& gaussians, const VoxelSet& set) const;
    /// Byte per Gaussian: 1 within the reach.
    std::vector<std::uint8_t> all_rows(const GaussianSpans& gaussians) const;

private:
    std::size_t cell(int x, int y, int z) const;
    bool within(const Place& place) const;
    bool reached(const GaussianSpans& gaussians, std::size_t row, Vec3& place) const;

    GridFrame frame_;
    std::array<Vec3, 3> axes_;
    std::array<int, 3> dimensions_{}, offset_{};
    std::vector<int> index_;  // of each cell; -1 = not solid
    std::vector<Place> places_;
    std::vector<std::array<float, 3>> colours_;
    std::vector<std::vector<std::uint32_t>> layers_;
};

}  // namespace gse::localize
