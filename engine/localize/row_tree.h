// k-d tree over some rows of a set (nanoflann); private to this room.
#pragma once

#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::localize {

/// Rows of a set as nanoflann wants them.
struct RowPoints {
    std::vector<float> position;     // [M,3]
    std::vector<std::uint32_t> row;  // [M]

    void add(const GaussianSpans& gaussians, std::size_t which) {
        row.push_back(static_cast<std::uint32_t>(which));
        for (std::size_t axis = 0; axis < 3; ++axis) position.push_back(gaussians.position[which * 3 + axis]);
    }
    std::size_t kdtree_get_point_count() const { return row.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const { return position[index * 3 + axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using RowTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, RowPoints>, RowPoints, 3, std::uint32_t>;
constexpr std::size_t RowTreeLeaf = 16;

inline bool finite_position(const GaussianSpans& gaussians, std::size_t row) {
    return std::isfinite(gaussians.position[row * 3]) && std::isfinite(gaussians.position[row * 3 + 1]) &&
           std::isfinite(gaussians.position[row * 3 + 2]);
}

}  // namespace gse::localize
