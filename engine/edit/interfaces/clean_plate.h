// What a thing hid from a view: what is left of the scene without it, and a guess for where that has holes.
#pragma once

#include <cstddef>

#include "engine/base/image.h"

namespace gse::edit {

/// A view of the scene without what may change.
struct CleanPlate {
    Image picture;     // [H,W,3] in [0,1]
    Image depth;       // [H,W,1] along z, 0 = nothing there
    Mask filled = {};  // 1 = a guess: there was a hole; empty before fill_holes()
};

/// Fills the holes of a backdrop, colour and depth, from their surroundings, and marks them: both solve
/// Laplace's equation between what is known around a hole, the depth as 1/z, which is linear across the
/// picture of a plane. A hole is an empty place inside `mask` that is enclosed by what is there (it does not
/// touch the picture's rim nor anything empty outside the mask, as sky does), with the rim around it that is
/// not quite opaque, whose colour is in part that of what is behind the scene. `alpha` [H,W,1]: opacity of
/// the backdrop. Returns how many pixels were filled.
std::size_t fill_holes(CleanPlate& backdrop, const Mask& mask, const Image& alpha);

}  // namespace gse::edit
