// Displacement of a redrawn picture against the one that was sent, estimated where nothing should change.
#pragma once

#include <optional>

#include "engine/base/image.h"

namespace gse::remote {

/// Similarity from places of the sent picture to places of the drawn one, about the picture's middle.
struct Similarity {
    double scale = 1;
    double angle = 0;       // radians
    double dx = 0, dy = 0;  // shares of the picture's side
    /// Largest displacement of a corner, as a share of the side.
    double reach() const;
};

/// Displacement of `drawn` against `sent`, [S,S,3] both, over pixels outside of `changed` [S,S]. An
/// exhaustive search of shifts at a coarse size, then Gauss-Newton on the similarity and an offset of
/// brightness. Nothing where fewer than a hundredth of the pixels count, where they
/// show no structure, and where no displacement of at most a fifth of the side was found.
std::optional<Similarity> register_pictures(const Image& sent, const Image& drawn, const Mask& changed);

/// Drawn picture moved back onto the sent one; bilinear, its rim repeated.
Image moved_back(const Image& drawn, const Similarity& similarity);

}  // namespace gse::remote
