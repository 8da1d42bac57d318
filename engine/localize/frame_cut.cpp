// Nearest neighbours of labelled rows by a k-d tree, projected into every picture.
#include "engine/localize/frame_cut.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/row_tree.h"

namespace gse::localize {
namespace {

constexpr float FaintLogit = -5.5373f;  // opacity 1/255: not seen
constexpr double Margin = 0.25;         // of a label's box, on each side: its neighbours lie within

struct Surroundings {
    std::array<float, 3> low, high;
    bool holds(const float* at) const {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (at[axis] < low[axis] || at[axis] > high[axis]) return false;
        return true;
    }
};

bool is_seen(const GaussianSpans& gaussians, std::size_t row) {
    return gaussians.opacity_logit[row] > FaintLogit && finite_position(gaussians, row);
}

Surroundings around_label(const GaussianSpans& gaussians, std::span<const std::uint8_t> bits) {
    Surroundings box;
    box.low.fill(std::numeric_limits<float>::max());
    box.high.fill(std::numeric_limits<float>::lowest());
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (bits[row] == 0 || !is_seen(gaussians, row)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], gaussians.position[row * 3 + axis]);
            box.high[axis] = std::max(box.high[axis], gaussians.position[row * 3 + axis]);
        }
    }
    float side = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) side = std::max(side, box.high[axis] - box.low[axis]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] -= static_cast<float>(Margin) * side;
        box.high[axis] += static_cast<float>(Margin) * side;
    }
    return box;
}

bool in_picture(const Camera& camera, const float* at) {
    const Vec3 seen = camera.to_camera({at[0], at[1], at[2]});
    if (!(seen.z > 0)) return false;
    const double x = camera.fx * seen.x / seen.z + camera.cx, y = camera.fy * seen.y / seen.z + camera.cy;
    return x >= 0 && y >= 0 && x < camera.width && y < camera.height;
}

}  // namespace

FrameCut frame_cut(const GaussianSpans& gaussians, std::span<const std::uint8_t> bits,
                   std::span<const Camera> cameras, const FrameCutParameters& parameters,
                   ThreadPool* threads) {
    GSE_CHECK_EQ(bits.size(), gaussians.size);
    GSE_CHECK(parameters.neighbours > 0);
    if (cameras.empty()) return {};
    const Surroundings box = around_label(gaussians, bits);
    RowPoints near, labelled;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (!is_seen(gaussians, row) || !box.holds(&gaussians.position[row * 3])) continue;
        near.add(gaussians, row);
        if (bits[row] != 0) labelled.add(gaussians, row);
    }
    if (labelled.row.empty()) return {};
    near = along_curve(gaussians, near);
    labelled = along_curve(gaussians, labelled);
    const RowTree tree(3, near, nanoflann::KDTreeSingleIndexAdaptorParams(RowTreeLeaf));
    std::atomic<std::size_t> border{0}, beyond{0};
    const double most_outside = parameters.outside_share * static_cast<double>(cameras.size());
    const auto take = [&](std::size_t, std::span<const std::uint32_t> nearest, std::span<const float>) {
        for (const auto index : nearest) {
            if (bits[near.row[index]] != 0) continue;
            const auto outside = std::count_if(cameras.begin(), cameras.end(), [&](const Camera& camera) {
                return !in_picture(camera, &near.position[std::size_t{index} * 3]);
            });
            border.fetch_add(1, std::memory_order_relaxed);
            if (static_cast<double>(outside) > most_outside) beyond.fetch_add(1, std::memory_order_relaxed);
        }
    };
    nearest_of_all(tree, labelled.position, static_cast<std::size_t>(parameters.neighbours) + 1, threads,
                   take);  // itself among them
    return {border, beyond};
}

}  // namespace gse::localize
