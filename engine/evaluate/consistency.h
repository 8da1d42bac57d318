// Does an edit look the same from neighbouring directions?
#pragma once

#include <span>

#include "engine/base/image.h"

namespace gse::evaluate {

/// Pictures along a path of cameras: as it was, as it is now, and where the edit is in each.
struct PathPictures {
    std::span<const Image> before, after;  // [H,W,3]
    std::span<const Mask> masks;
    bool closed = true;  // the last picture is a neighbour of the first
};

/// Inconsistency of an edit: the mean colour change inside the mask is taken in every picture; the result is
/// the mean absolute difference (per channel, in display values) of it between neighbours. 0 = from
/// everywhere the same change, also for no change at all. No picture is warped onto another: what is compared
/// is the edit's colour as a whole, and what the scene itself shows differently from side to side cancels,
/// since `before` is taken away. Neighbours of which one has an empty mask are left out; 0 when none is left.
double path_inconsistency(const PathPictures& pictures);

}  // namespace gse::evaluate
