// Clean plate of a view: the scene without the edited object, and a guess for its holes (METHOD.md, Clean
// plates).
#pragma once

#include <cstddef>

#include "engine/base/image.h"

namespace gse::edit {

/// View of the scene without the splats that may change.
struct CleanPlate {
    Image picture;     // [H,W,3] in [0,1]
    Image depth;       // [H,W,1] along z, 0 = nothing there
    Mask filled = {};  // 1 = a guess: there was a hole; empty before fill_holes()
};

/// Fills the holes of a clean plate, colour and depth, from their surroundings, and marks them. Both solve
/// Laplace's equation between the known values around a hole. Depth is filled as 1/z, which is linear across
/// the picture of a plane. Returns how many pixels were filled.
///
/// A hole is an empty place inside `mask` that the scene encloses: it touches neither the picture's rim nor
/// empty pixels outside the mask (sky). Its rim that is not quite opaque belongs to it, since its colour is
/// in part the background's. `alpha` [H,W,1] is the opacity of the plate.
std::size_t fill_holes(CleanPlate& clean_plate, const Mask& mask, const Image& alpha);

}  // namespace gse::edit
