// Figures of merit of a localization and an edit: overlap, picture error in and outside a mask, leak and
// drift.
#pragma once

#include <cstdint>
#include <span>

#include "engine/base/image.h"
#include "engine/scene/gaussian_set.h"

namespace gse::evaluate {

/// Overlap of two sets.
struct Overlap {
    double iou = 1;        // intersection / union; 1 when both are empty
    double precision = 1;  // 1 when nothing was predicted
    double recall = 1;     // 1 when nothing was true
    double f1 = 1;
};

/// Overlap of rows: nonzero = in the set. `weights` (empty = all 1) makes a row count as much as it is seen,
/// e.g. by the sum of alpha T over all views. A huge faint splat then weighs less than a surface one
/// (METHOD.md, Metrics).
Overlap row_overlap(std::span<const std::uint8_t> predicted, std::span<const std::uint8_t> truth,
                    std::span<const double> weights = {});

/// Overlap of the set pixels of two masks of equal size.
Overlap mask_overlap(const Mask& predicted, const Mask& truth);

/// F1 of two outlines. An outline pixel counts as matched when the other outline is at most `tolerance_px`
/// away.
double boundary_f(const Mask& predicted, const Mask& truth, double tolerance_px = 2);

/// Tolerance of an outline, as a share of the picture's diagonal: that of video segmentation (DAVIS 2016).
inline constexpr double BoundaryToleranceShare = 0.008;

/// That share in pixels, at least 1. Small pictures have no finer outline.
double boundary_tolerance_px(int width, int height);

/// Pixels that a picture measure covers: those with mask == `inside`, or all without a mask.
struct Region {
    const Mask* mask = nullptr;
    bool inside = true;
    bool contains(std::size_t pixel) const { return mask == nullptr || (mask->data[pixel] != 0) == inside; }
};

/// Highest value psnr_db returns, for equal pictures.
inline constexpr double PsnrLimitDb = 100;

/// 10 log10(1 / mean squared error) over the region's pixels and channels, at most PsnrLimitDb.
double psnr_db(const Image& a, const Image& b, const Region& region = {});

/// Mean absolute difference over the region.
double mean_absolute_error(const Image& a, const Image& b, const Region& region = {});

/// Mean over the region of the SSIM map (11x11 Gaussian window, sigma 1.5, C1 = 1e-4, C2 = 9e-4, zero
/// padding).
double ssim(const Image& a, const Image& b, const Region& region = {});

/// Mean squared magnitude of the gradient: forward differences, mean over channels. A pixel counts where the
/// region holds it and its neighbours to the right and below. 0 where no pixel counts.
double gradient_energy(const Image& image, const Region& region = {});

/// Colour difference that a display of 8 bits shows beyond rounding.
inline constexpr double LeakTolerance = 2.0 / 255;

/// Share of the region's pixels whose largest channel difference exceeds `threshold`. 0 for an empty region.
double leak_rate(const Image& a, const Image& b, const Region& region, double threshold = LeakTolerance);

/// Byte per pixel: 1 if the largest channel difference exceeds `threshold`.
Mask changed_pixels(const Image& a, const Image& b, double threshold);

/// Euclidean distance of the mean colours of a and b over the region: the colour error of a recolouring.
double mean_colour_error(const Image& a, const Image& b, const Region& region = {});

/// Number of rows of equal index whose bits differ in any attribute, among rows with counted[row] != 0. Both
/// sets must have one SH degree. Rows beyond the shorter set count as different.
std::size_t changed_rows(const GaussianSet& before, const GaussianSet& after,
                         std::span<const std::uint8_t> counted);

/// Drift of an edit: rows of `before` with label[row] == 0 that are gone (before_to_after[row] < 0) or differ
/// in any bit from the row of `after` they became.
std::size_t drifted_rows(const GaussianSet& before, const GaussianSet& after,
                         std::span<const std::int64_t> before_to_after, std::span<const std::uint8_t> label);

}  // namespace gse::evaluate
