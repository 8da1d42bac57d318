// Frame of a view that is sent to a server: which part of it, at what size, with which mask.
#pragma once

#include <vector>

#include "engine/edit/interfaces/view_section.h"

namespace gse::remote {

/// Least side of a part that is cut out of a view, px.
inline constexpr int LeastCrop = 512;

/// Part of a square view as it is sent. Pictures are squares of one side.
struct ViewFrame {
    edit::ViewSection section;  // of the view
    Image picture;              // [S,S,3] in [0,1] to redraw
    Image original;             // [S,S,3] the unedited scene there
    Mask mask;                  // [S,S] where it may change
    int view_side = 0;          // px of the view
    Mask sent_mask;             // the mask as the server is told: grown, so that its rim can change
};

/// Side of the parts that are cut out of these views, px of the views; one for all, so that the model sees
/// things at one scale. It holds the largest mask with a margin. The whole side where little would be left
/// out.
int crop_side(const std::vector<edit::EditView>& views);

/// Square of that side around the mask, inside the view.
edit::ViewSection crop_around(const Mask& mask, int side);

/// Frame of that part of a view. `side` of the sent picture, px; `latent_cell`: px of a cell of the model's
/// latent.
ViewFrame frame_of(const edit::EditView& view, const edit::ViewSection& section, int side, int latent_cell);

/// Part of a whole picture of the view [S,S,3], of any side, that the frame shows.
Image framed(const Image& whole, const ViewFrame& frame);

/// Side that a family's picture is sent at: `asked`, or the family's where it is 0, as a multiple of `step`
/// px.
int sent_side(int asked, int family_side, int step);

/// Picture as a square of that side: mean of areas, bilinear where it grows.
Image at_side(const Image& picture, int side);
/// Square mask at another side: pixels that are half covered.
Mask at_side(const Mask& mask, int side);

/// [H,W,1] copy for servers, 1 = change.
Image as_image(const Mask& mask);

/// Picture that the view shows once the part is redrawn: inside the mask as `drawn` [S,S,3], feathered; the
/// rendered view elsewhere.
Image pasted(const edit::EditView& view, const ViewFrame& frame, const Image& drawn);

}  // namespace gse::remote
