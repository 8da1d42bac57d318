// Gaussians under affine maps: positions, shapes and view-dependent colours.
#pragma once

#include <cstdint>
#include <span>

#include "engine/scene/gaussian_set.h"
#include "engine/scene/transform/affine.h"

namespace gse {

/// All Gaussians under the map. A picture of the result by a camera that is turned, moved or mirrored with
/// them is the picture of before.
///
/// Under similarities rotations are turned and log-scales shifted. Otherwise the covariance S becomes
/// A S A^T, and colours turn by the orthogonal factor of A. Mirror images are exact. The identity changes no
/// bit. The map must have an inverse. Rows that cannot be drawn keep their shape.
GaussianData transformed(GaussianData data, const Affine& affine);

/// The set with the map done to the rows whose byte in `rows` [N] is set. Other rows keep their bits.
/// Attributes that the map leaves alone are shared: a move copies the positions only.
GaussianSet transformed(const GaussianSet& set, std::span<const std::uint8_t> rows, const Affine& affine);
/// All rows.
GaussianSet transformed(const GaussianSet& set, const Affine& affine);

}  // namespace gse
