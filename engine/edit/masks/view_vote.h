// Vote of one view of a search, from which labels are fused (METHOD.md, Label voting).
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/masks/view_evidence.h"
#include "engine/scene/label_field.h"

namespace gse::edit {

/// [H,W,1], 0 or 1.
Image mask_image(const Mask& mask);

/// Probability of each pixel in a view, [H,W,1] in [0,1]. A mask cut out by colours has sharp edges but
/// misses parts of another colour (a mushroom's stem, a car's windows). The attention is blurred but includes
/// them. Where the two disagree, the other views and the cut between neighbours decide. Parts that another
/// named object has for sure (the white legs of a dog on snow) are not taken from it. The mask of a trusted
/// segmenter is taken as it is.
Image vote_of(const ViewEvidence& view, double threshold);

/// Margin of the competing words' maps (`competitor_margin`); maps[0] is the view's own. Words that the user
/// gave (`strict`) take every pixel they have more of. Words of the sentence only count in vote_of(): the
/// attention of a wide ground is strong under the feet of an object on it.
void suppress_competitors(ViewEvidence& view, const std::vector<Image>& maps, bool strict);

/// The largest of its values; those that are not finite do not count.
float largest_value(const Image& map);

/// Views, by their number, in which what a word means is out of sight, by the most attention that it draws in
/// each of them: much less than in most. At most half of them.
std::vector<std::size_t> faint_views(const std::vector<float>& peaks);

/// Throws Error (InvalidArgument) for a view that is none of `count`.
void require_views(const std::vector<std::size_t>& excluded, std::size_t count);

/// Views that do not vote, by their number: marked as such. Throws Error (InvalidArgument) for one that is
/// not there.
void exclude_views(std::vector<ViewEvidence>& views, const std::vector<std::size_t>& excluded);

/// Coverage from which a row counts as seen, in pixels: `asked` is meant for scenes whose splats cover a few
/// pixels; in denser ones no splat has that much.
double least_coverage(const LabelField& field, double asked);

}  // namespace gse::edit
