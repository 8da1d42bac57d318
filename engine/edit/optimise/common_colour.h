// Change of colour that all splats of a label share.
#pragma once

#include <span>
#include <vector>

#include "engine/edit/optimise/adam.h"
#include "engine/math/eigen.h"

namespace gse::edit {

/// Low-rank change colour' = colour + A colour_at_birth + b for all rows of a label, which keeps texture,
/// shading and black. A is learned along the axes of the label's own colours, each measured by the spread of
/// the colours along it. The first axis is mostly light and shade. The others tell paint from trim and grain
/// from gaps; without the axes Adam would move them together. View-dependent coefficients are colours without
/// the constant, so A applies to them, too.
class CommonColour {
public:
    CommonColour() = default;
    /// `birth` [rows,stride] holds spherical harmonics at birth, RGB triples, the DC term first.
    CommonColour(std::span<const float> birth, std::size_t stride);

    /// One Adam step along the mean over the rows; adds the step to `sh`. All arrays are [rows,stride]. Rows
    /// may come and go between steps. Colours beyond those of the constructor's rows count as the nearest of
    /// them along each axis. An axis of little spread says nothing about other colours.
    void step(std::span<const float> gradient, std::span<const float> birth, std::span<float> sh,
              double rate);
    /// Adds all learned changes so far to rows that start as `birth`.
    void apply(std::span<const float> birth, std::span<float> sh) const { add(learned_, birth, sh); }

private:
    static constexpr std::size_t Terms = 4;  // constant and three axes
    using Coefficients = std::array<float, 3 * Terms>;

    std::array<double, Terms> terms(const float* birth) const;
    void add(const Coefficients& change, std::span<const float> birth, std::span<float> sh) const;

    std::size_t stride_ = 3;
    std::array<Vec3, 3> axis_{};            // colour along axis k = dot(axis_[k], colour)
    std::array<double, 3> low_{}, high_{};  // of the first rows' colours along each axis
    Coefficients learned_{};
    AdamMoments moments_;
    int steps_ = 0;
};

}  // namespace gse::edit
