// Differences of a redrawn picture from the scene, and the outline of something new in it.
#pragma once

#include <span>

#include "engine/base/image.h"

namespace gse::remote {

/// Largest difference of a pixel's channels, [H,W,1], blurred over `blur_px`.
Image change_map(const Image& before, const Image& after, double blur_px);

/// Outcome of a look for what a server has changed in a picture.
enum class ChangeFound {
    Part,        // of the picture
    Nothing,     // that stands out
    Everywhere,  // the picture as a whole is another one
};

/// Part of a picture that a server changed, told by differences alone.
struct ChangedPart {
    ChangeFound found = ChangeFound::Nothing;
    Image map;  // [H,W,1] in [0,1]: 0.5 at the level, 1 where the change is sure; 0 outside of the part
    Mask mask;  // [H,W] map above 0.5
    double level = 0;  // change from which a pixel belongs to the part
};

/// Part that one or more pictures `after` differ in, all [H,W,3]. The least difference of each pixel counts:
/// what one of them changed by chance, another did not. Even shifts of colour are taken off, and so is what
/// the whole picture lost. The level is Otsu's where the differences are of two kinds, else three times their
/// mean (as in DiffEdit, Couairon et al. 2022). Pieces that are small beside the largest are left out.
ChangedPart changed_part(const Image& before, std::span<const Image> after);

/// Drawn picture moved back onto `before`, where that makes them more alike; both [S,S,3].
Image aligned(const Image& before, Image drawn);

/// Coverage [H,W,1] in [0,1] of what is new inside `mask`: changes above Otsu's threshold of those inside.
/// All zero where no change stands out.
Image outline_of_change(const Image& change, const Mask& mask);

}  // namespace gse::remote
