// Mask of a word in a picture: one finder for the search, for masks that follow an edit, and for the look at
// added objects.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/masks/search_outcome.h"
#include "engine/edit/request/request.h"

namespace gse::edit {

constexpr double LeastTextScore = 0.3;  // of a text segmenter that sees the word (METHOD.md, Masks in a view)

/// Outcome of a picture. Masks have the picture's size.
struct WordMask {
    Mask region;  // attention above the threshold, cleaned
    Mask mask;    // the region, or what a segmenter made of it; empty of pixels where nothing was found
    std::vector<PointPrompt> points;  // clicks for the segmenter
    double captured = 0;              // share of the region's attention inside the mask
    std::string branch = "none";      // what the mask is from: "text", "points" or "attention"
    bool trusted = false;             // the mask is from a segmenter that is trusted: it trims the attention
    ViewStep step = ViewStep::Found;  // in which step it ended
    bool found() const { return step == ViewStep::Found; }
};

/// Segmenters; both may be null, then the region is the mask.
struct WordMaskTools {
    Segmenter* segmenter = nullptr;
    TextSegmenter* text_segmenter = nullptr;
};

/// The least box around a mask's pixels, which has some.
BoxPrompt bounds_of(const Mask& mask);

/// Scales an attention map to a maximum of 1; negative and non-finite values become 0. Returns how many were
/// not finite.
std::size_t normalise_maximum(Image& map);

/// Mask of a word by threshold and DBSCAN on a 64-cell grid, with small clusters dropped (METHOD.md, Masks in
/// a view). It is refined by a text segmenter that agrees with the attention, or by a segmenter from clicks
/// and box. Otherwise it is the region itself. `picture` [H,W,3] and `map` [H,W,1] are in [0,1], of one size.
/// `refines` = false: the region is enough.
///
/// | constant | value | chosen |
/// |---|---|---|
/// | cells of the grid | 64 | as the paper |
/// | least region | 4 cells | as many as DBSCAN's core needs neighbours; by judgement |
/// | largest mask | 0.9 of the picture | such a mask says nothing about where; by judgement |
/// | largest growth | 4 times the region | a segmenter that ran away into the background; by judgement |
/// | overlap with a text segmenter | IoU 0.1 | METHOD.md, Masks in a view |
/// | least text score | 0.3 | METHOD.md, Masks in a view |
/// | captured attention | `min_segment_attention` | a setting |
WordMask find_word_mask(const Image& picture, const Image& map, double threshold, const std::string& word,
                        const SearchSettings& settings, const WordMaskTools& tools, bool refines = true);

}  // namespace gse::edit
