// A thing that a server was told to paint in one flat colour: the colour that suits a picture, and the part
// that has it afterwards (METHOD.md, Search by differences).
#pragma once

#include <array>
#include <string_view>

#include "engine/base/image.h"
#include "engine/remote/views/change_map.h"

namespace gse::remote {

/// A saturated colour with the words by which models know it.
struct PaintColour {
    std::string_view words;    // "pure magenta (#FF00FF)"
    std::array<float, 3> rgb;  // display values in [0,1]
};

/// Colour of six that is rarest in a picture [H,W,3].
const PaintColour& rarest_colour(const Image& picture);

/// Part of `after` that has the colour's hue, shaded or not, and had not before; pictures [H,W,3] of one
/// size. A part is taken for one thing only where 0.3 % to 60 % of the picture are painted, most of it in
/// large pieces.
ChangedPart painted_part(const Image& before, const Image& after, const PaintColour& colour);

}  // namespace gse::remote
