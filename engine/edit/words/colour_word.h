// A colour for a new thing of which the sentence names none: each redrawn view would invent its own, and a
// scene fitted to all of them is speckled. One view is drawn first; the word for what it shows joins the
// sentence for all.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// CIE 1976 L*a*b* of sRGB in [0,1] under D65 (IEC 61966-2-1, CIE 15).
std::array<double, 3> lab_of(const std::array<double, 3>& srgb);

/// Luma of a pixel of a picture [H,W,3] (Rec. 709 weights on display values).
inline float luma_of(const Image& picture, std::size_t pixel) {
    return 0.2126f * picture.data[pixel * 3] + 0.7152f * picture.data[pixel * 3 + 1] +
           0.0722f * picture.data[pixel * 3 + 2];
}

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
