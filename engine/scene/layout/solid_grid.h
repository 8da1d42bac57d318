// Splats as samples of surfaces, and the cells of space that hold most of what is seen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse {

/// One splat as a piece of a surface.
struct SurfaceSample {
    Vec3 at;                       // world
    Vec3 normal;                   // shortest axis; its sign means nothing
    double weight = 0;             // opacity times area, world units squared
    double flatness = 0;           // 0 = round, 1 = flat
    std::array<double, 3> colour;  // base colour in [0,1]
};

/// At most `most` evenly chosen rows that can be drawn and are not faint. Rows with skip[row] != 0 are left
/// out; `skip` may be empty.
std::vector<SurfaceSample> surface_samples(const GaussianSet& set, std::size_t most,
                                           std::span<const std::uint8_t> skip = {});

/// Cubic cells along the world's axes. Solid cells are the densest ones that together hold most of the
/// weight; the grid is trimmed to them.
class SolidGrid {
public:
    using Cell = std::array<int, 3>;

    /// Grid of `cells` cells along the longest side of the samples' robust box. Empty without samples.
    SolidGrid(std::span<const SurfaceSample> samples, int cells);

    bool empty() const { return solid_.empty(); }
    const Cell& size() const { return size_; }
    bool solid(const Cell& cell) const { return solid_[index(cell)] != 0; }
    std::size_t solid_count() const { return solid_count_; }
    /// World position of the grid's low corner, and side of a cell.
    const Vec3& low() const { return low_; }
    double side() const { return side_; }
    /// True for samples in solid cells; sets `cell`.
    bool find(const Vec3& at, Cell& cell) const;
    std::size_t index(const Cell& cell) const {
        return (static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(cell[1])) *
                   static_cast<std::size_t>(size_[2]) +
               static_cast<std::size_t>(cell[2]);
    }

private:
    bool place(const Vec3& at, Cell& cell) const;
    void trim();

    Cell size_{};
    Vec3 low_;
    double side_ = 0;
    std::vector<std::uint8_t> solid_;  // [size_[0],size_[1],size_[2]]
    std::size_t solid_count_ = 0;
};

}  // namespace gse
