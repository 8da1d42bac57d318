// Pixels of a redrawn picture that show the new object.
#pragma once

#include "engine/base/image.h"

namespace gse::edit {

/// Share of each pixel of `inside` that the object covers, from the model's own outline ([H,W,1] in [0,1]).
/// Only parts that are half covered somewhere count. Holes are filled and stray pixels dropped.
Image told_thing(const Image& outline, const Mask& inside);
/// Pixels of which at least the share `least` is covered.
Mask covered_pixels(const Image& share, double least = 0.5);
/// Pixels of `inside` that differ from the picture without the object and have some attention. `change`
/// [H,W,1] is the difference. `map` [H,W,1], maximum 1, is the attention of the object's word; `level` is its
/// threshold. Holes are filled and stray pixels dropped.
Mask changed_thing(const Image& change, const Mask& inside, const Image& map, double level);
/// Variant of changed_thing() for a known picture `without` whose redrawn version is not known. Pixels with
/// much attention count, too.
Mask thing_in_picture(const Image& picture, const Image& without, const Mask& inside, const Image& map,
                      double level);

}  // namespace gse::edit
