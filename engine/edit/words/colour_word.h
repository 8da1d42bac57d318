// A colour for a new thing of which the sentence names none: each redrawn view would invent its own, and a
// scene fitted to all of them is speckled. One view is drawn first; the word for what it shows joins the
// sentence for all.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// A vote of pixels on the basic colour term (Berlin and Kay 1969) that is nearest to them, in CIELAB with
/// lightness at half weight: shading changes it most. Only words of `known` where it is not empty. Black,
/// white and grey stand together against the hues: light and shade divide the votes for a thing that has
/// none.
class ColourVote {
public:
    explicit ColourVote(const std::vector<std::string>& known);
    /// `picture` [H,W,3] sRGB in [0,1]; `share` [H,W,1]: pixels above one half vote.
    void add(const Image& picture, const Image& share);
    /// Empty when no pixel has voted or no such word is known.
    std::string winner() const;

private:
    std::vector<std::size_t> terms_, votes_;  // indices of the known ones, and of each its votes
};

/// That of one picture.
std::string colour_shown(const Image& picture, const Image& share, const std::vector<std::string>& known);

}  // namespace gse::edit
