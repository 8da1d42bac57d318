// What one view of a search says, as the vote that labels are fused from.
#pragma once

#include "engine/edit/locate.h"

namespace gse::edit {

/// [H,W,1], 0 or 1.
Image mask_image(const Mask& mask);

/// What a view says about its pixels, [H,W,1] in [0,1]. A mask cut out by colours has sharp edges but leaves out what has
/// another colour (a mushroom's stem, a car's windows); the attention is blurred but knows that they belong. Where the
/// two disagree, the other views and the cut between neighbours decide; what another named thing has for sure (the white
/// legs of a dog on snow) the mask does not take from it. The mask of a segmenter that is trusted is believed as it is.
Image vote_of(const ViewEvidence& view, double threshold);

}  // namespace gse::edit
