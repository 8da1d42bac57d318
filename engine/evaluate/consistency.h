// Consistency of an edit between neighbouring directions.
#pragma once

#include <span>

#include "engine/base/image.h"

namespace gse::evaluate {

/// Pictures along a path of cameras: before, after, and the mask of the edit in each.
struct PathPictures {
    std::span<const Image> before, after;  // [H,W,3]
    std::span<const Mask> masks;
    bool closed = true;  // the last picture is a neighbour of the first
};

/// Inconsistency of an edit: the mean absolute difference between neighbours of the mean colour change inside
/// the mask. Per channel, in display values. 0 = the change is equal from everywhere, also for no change at
/// all.
///
/// No picture is warped onto another. The edit's colour is compared as a whole, and differences of the scene
/// itself cancel, since `before` is taken away. Neighbours with an empty mask are left out; 0 when none is
/// left.
double path_inconsistency(const PathPictures& pictures);

}  // namespace gse::evaluate
