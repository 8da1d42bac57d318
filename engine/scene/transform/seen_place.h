// Place in front of what a view shows, for a thing that is put into a scene.
#pragma once

#include "engine/base/image.h"
#include "engine/math/camera.h"

namespace gse {

/// Surface that a view shows.
struct SeenSurface {
    Camera camera;  // of the depth's size
    Image depth;    // [H,W,1] along the camera's axis; 0 = nothing is seen
    /// True where nothing at all is seen.
    bool empty() const;
};

struct SeenPlace {
    Vec3 foot{};
    double factor = 1;   // of the thing's size
    bool suits = true;   // its own size is kept
    bool stands = true;  // on a support; else it hangs
};

/// Foot and size at which a box is seen whole, with nothing in front of it, nearest to the middle of the
/// view.
///
/// y is up. The box stands on a support that the view shows, or hangs in front of the nearest surface at the
/// middle where no support has room for it. Its own size is kept if `fixed`, and where it takes between a
/// twelfth and 0.6 of the view's height. Else it takes a third of that, or less where this has no room. The
/// surface must not be empty. `size`: of the box; its longest side is above 0.
SeenPlace seen_place(const SeenSurface& surface, const Vec3& size, bool fixed);

}  // namespace gse
