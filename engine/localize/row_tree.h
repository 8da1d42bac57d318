// k-d tree over some rows of a set (nanoflann), asked for many points at once. Private to this room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <nanoflann.hpp>
#include <span>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/scene/gaussian_set.h"
#include "engine/scene/morton.h"

namespace gse::localize {

/// Rows of a set in nanoflann's interface.
struct RowPoints {
    std::vector<float> position;     // [M,3]
    std::vector<std::uint32_t> row;  // [M]

    void add(const GaussianSpans& gaussians, std::size_t which) {
        row.push_back(static_cast<std::uint32_t>(which));
        for (std::size_t axis = 0; axis < 3; ++axis) position.push_back(gaussians.position[which * 3 + axis]);
    }
    std::size_t kdtree_get_point_count() const { return row.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const { return position[index * 3 + axis]; }
    template <class Box> bool kdtree_get_bbox(Box&) const { return false; }
};

using RowTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, RowPoints>, RowPoints,
                                                    3, std::uint32_t>;
constexpr std::size_t RowTreeLeaf = 16;

/// The rows along a space-filling curve. Neighbours in it are near each other, in space and in memory.
inline RowPoints along_curve(const GaussianSpans& gaussians, const RowPoints& rows) {
    RowPoints sorted;
    sorted.row.reserve(rows.row.size());
    sorted.position.reserve(rows.position.size());
    for (const auto i : morton_order(rows.position)) sorted.add(gaussians, rows.row[i]);
    return sorted;
}

/// Calls take(point, numbers, squared distances) once for every point of [M,3], with the nearest rows of the
/// tree, nearest first. Rows as far away as `reach` are left out. Calls come from any thread of the pool
/// (null = this one). Fast if consecutive points are near each other.
inline void nearest_of_all(
    const RowTree& tree, std::span<const float> points, std::size_t wanted, ThreadPool* threads,
    const std::function<void(std::size_t, std::span<const std::uint32_t>, std::span<const float>)>& take,
    double reach = std::numeric_limits<double>::infinity()) {
    const auto least_far =
        static_cast<float>(std::min(reach * reach, double{std::numeric_limits<float>::max()}));
    const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
        std::vector<std::uint32_t> nearest(wanted);
        std::vector<float> squared(wanted);
        for (std::size_t i = begin; i < end; ++i) {
            nanoflann::KNNResultSet<float, std::uint32_t> result(wanted);
            result.init(nearest.data(), squared.data());
            squared.back() = least_far;  // the worst so far: nothing beyond it is looked at
            tree.findNeighbors(result, &points[i * 3], nanoflann::SearchParams());
            take(i, std::span(nearest).first(result.size()), std::span(squared).first(result.size()));
        }
    };
    constexpr std::size_t chunk = 4096;
    if (threads != nullptr) threads->parallel_for(points.size() / 3, chunk, some);
    else some(0, points.size() / 3, 0);
}

inline bool finite_position(const GaussianSpans& gaussians, std::size_t row) {
    return std::isfinite(gaussians.position[row * 3]) && std::isfinite(gaussians.position[row * 3 + 1]) &&
           std::isfinite(gaussians.position[row * 3 + 2]);
}

}  // namespace gse::localize
