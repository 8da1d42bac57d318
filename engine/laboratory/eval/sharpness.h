// Sharpness of a new thing against the true one, in pictures of one size (METHOD.md, Metrics).
#pragma once

#include <cstddef>

#include "engine/base/image.h"

namespace gse::bench {

/// Side of the pictures that sharpness is measured in.
inline constexpr int SharpSide = 256;
/// Pixels of SharpSide that are left out along the true outline. The outline is an edge of its own, and has a
/// figure of its own.
inline constexpr double OutlineMarginPx = 2;

/// Sharpness within the true outline, pooled over pictures.
class SharpnessFigures {
public:
    /// `outline`: pixels of the true thing in `truth`.
    void add(const Image& shown, const Image& truth, const Mask& outline);
    /// SSIM within the outline, 0 without a pixel.
    double ssim() const;
    /// Gradient energy over that of the truth, within the outline less its margin. 0 where the truth has
    /// none.
    double gradient_energy() const;

private:
    double similar_ = 0, pixels_ = 0, shown_energy_ = 0, true_energy_ = 0;
};

}  // namespace gse::bench
