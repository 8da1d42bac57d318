// Haze, floaters and sky far around a scene, which must not decide what a picture frames.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse {

/// Visible rows of a set, packed.
struct VisibleRows {
    std::vector<float> position;       // [M,3]
    std::vector<float> opacity_logit;  // [M]
    std::vector<float> log_size;       // [M] of the longest axis

    std::size_t size() const { return opacity_logit.size(); }
    void reserve(std::size_t rows);
    void add(const GaussianSpans& set, std::size_t row);
    /// Removes the rows with bits[row] != 0; none if `bits` is empty.
    void drop(std::span<const std::uint8_t> bits);
};

/// Splats far around the dense part of a scene that are no surface of it.
struct Surroundings {
    std::vector<std::uint8_t> rows;  // [M] 1 = haze or sky; empty if there is neither
    std::size_t haze = 0;            // faint, or scattered: no surface
    std::size_t sky = 0;             // on a shell around the scene
};

/// Tells haze and sky apart from the scene. A scene without a far denser core has none: open country, a room
/// around a thing and two things side by side are all scene.
Surroundings find_surroundings(const VisibleRows& rows);

/// Byte per row of the set [N]: 1 = haze or sky. Empty if there is neither.
std::vector<std::uint8_t> surrounding_rows(const GaussianSet& set);

}  // namespace gse
