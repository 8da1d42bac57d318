// The plain double-precision rasterizer as functions. Tests, finite differences and the bench compare to it.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/raster/plain_projection.h"

namespace gse::raster::plain {

/// Splats in drawing order: by depth as a float, then by row, so that every version breaks ties alike.
struct SplatList {
    std::vector<Splat> splats;
    std::size_t unusable_rows = 0;
};

void project_all(const Inputs& inputs, const View& view, SplatList& list);

/// Images in double precision; every array is indexed by pixel, row 0 on top.
struct Picture {
    std::vector<double> colour;           // [H*W,3] with the background
    std::vector<double> alpha, depth;     // [H*W]
    std::vector<double> transmittance;    // [H*W] at the end
    std::vector<std::int32_t> blended;    // [H*W]
    std::vector<std::uint8_t> ambiguous;  // [H*W] 1 where a float version may decide a cut differently
    std::size_t pairs_tested = 0, pairs_blended = 0;
};

void composite(const SplatList& list, const View& view, Picture& picture);

/// Gradient of sum(colour d_colour) + sum(alpha d_alpha) for every splat of the list.
struct PictureGradient {
    std::vector<double> colour;  // [H*W,3]
    std::vector<double> alpha;   // [H*W]
};

void composite_backward(const SplatList& list, const View& view, const PictureGradient& gradient,
                        std::vector<SplatGradient>& result);

/// Called for every blended pair with its weight alpha T, front to back in every pixel.
template <class Visit>
void for_each_blended(const SplatList& list, const Camera& camera, std::vector<double>& transmittance,
                      Visit&& visit);

}  // namespace gse::raster::plain

#include "engine/raster/plain_blend.inl"
