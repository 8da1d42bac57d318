// Where a redrawn picture shows the new thing.
#pragma once

#include "engine/base/image.h"

namespace gse::edit {

/// Where a redrawn picture shows a thing, by what the model tells of it ([H,W,1] in [0,1]): the share of each
/// pixel of `inside` that is covered, in parts that are half covered somewhere. Holes filled, stray pixels
/// gone.
Image told_thing(const Image& outline, const Mask& inside);
/// The pixels of which at least that share is covered.
Mask covered_pixels(const Image& share, double least = 0.5);
/// Where a redrawn picture shows a thing, by `map`, the attention of its word ([H,W,1], maximum 1; `level` is
/// its threshold), and by how much the picture differs from the one without the thing, [H,W,1]: the pixels of
/// `inside` that differ and have some attention. Holes filled, stray pixels gone.
Mask changed_thing(const Image& change, const Mask& inside, const Image& map, double level);
/// The same where only the picture `without` is known, not what the model makes of it: pixels with much
/// attention count, too.
Mask thing_in_picture(const Image& picture, const Image& without, const Mask& inside, const Image& map,
                      double level);

}  // namespace gse::edit
