// Edited views carried over to another view by depth.
#pragma once

#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::remote {

/// Part of a view that other views show.
struct WarpedView {
    Image picture;  // [H,W,3]; the view's render where nothing is known
    Mask known;     // inside the view's mask: shown by another view
};

/// Median of what the views `from` show, as `pictures` [H,W,3] have them, of each point inside the mask of
/// `to`. A point counts where both depths agree to 1 % and the surface is not seen at more than 70 degrees.
/// The rim of what is known, 2 px of a picture of ReferenceSide, is left out.
WarpedView warp_by_depth(const std::vector<const edit::EditView*>& from,
                         const std::vector<const Image*>& pictures, const edit::EditView& to);

}  // namespace gse::remote
