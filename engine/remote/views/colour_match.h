// Colours of a redrawn picture matched to those of the sent one, by what lies around the mask.
#pragma once

#include "engine/base/image.h"

namespace gse::remote {

/// Width of the ring around the mask that is compared, px of a picture of ReferenceSide.
inline constexpr double MatchRing = 16;

/// Redrawn picture [S,S,3] whose ring around `mask` has the mean and the deviation, in CIELAB, of the sent
/// picture's. Servers shift tones of the whole picture; the change inside keeps its distance to them.
Image match_colours(const Image& drawn, const Image& sent, const Mask& mask);

}  // namespace gse::remote
