// What a thing hid from a view: what is left of the scene without it, and a guess for where that has holes.
#pragma once

#include <cstddef>

#include "engine/base/image.h"

namespace gse::edit {

/// A view of the scene without what may change.
struct Backdrop {
    Image picture;   // [H,W,3] in [0,1]
    Image depth;     // [H,W,1] along z, 0 = nothing there
};

/// Fills the holes of a backdrop, colour and depth, from their surroundings. A hole is an empty place inside `mask` that is
/// enclosed by what is there: it does not touch the picture's rim nor anything empty outside the mask, as sky does. Returns how
/// many pixels were filled.
std::size_t fill_holes(Backdrop& backdrop, const Mask& mask);

}  // namespace gse::edit
