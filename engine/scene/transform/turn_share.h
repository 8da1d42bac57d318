// Turns that all rows of an edit make together, and parts of the way along them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "engine/scene/gaussian_set.h"
#include "engine/scene/transform/affine.h"

namespace gse {

/// Turn, with a move and an equal scale, that takes row from[k] of `before` to row k of `after`. Rows k with
/// from[k] past the end of `before` do not count. Nothing where the rows do not turn or do not move as one,
/// or where base colour or opacity changes.
std::optional<Affine> common_turn(const GaussianSpans& before, std::span<const std::size_t> from,
                                  const GaussianData& after);

/// Share in [0,1] of the way along a turn with a move and an equal scale: about the same axis by the share of
/// the angle, the shorter way round. Sizes change by the power of the share.
Affine share_of_turn(const Affine& turn, double share);

}  // namespace gse
