// Place and size of a scene that is put into another.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/scene/transform/affine.h"
#include "engine/scene/transform/seen_place.h"

namespace gse {

/// Wishes for the place of a scene in another. What is left open is chosen.
struct MergeWishes {
    std::optional<Vec3> at;       // place of its foot, in the coordinates of the scene that takes it
    double turn = 0;              // degrees about up, counter-clockwise as seen from above
    std::optional<double> scale;  // factor above 0
    // Surface that is looked at, in the coordinates of the scene that takes the other one in front of it.
    std::optional<SeenSurface> seen = std::nullopt;
};

/// Map from the coordinates of the one scene to those of the other, and what was chosen, one sentence each.
struct MergePlace {
    Affine placement;
    std::vector<std::string> notes;
};

/// Place for `guest` in `host`. Its up is turned to the host's.
///
/// Without a place it stands where the view shows it (seen_place()). Without a view that shows something,
/// it stands on the host's ground, near the middle where nothing is in its way; beside a host that has no
/// ground. Without a scale and a view it keeps its size if that is between a quarter and four times a third
/// of the host's size, and gets that third otherwise. Sizes are the longest sides of boxes without the
/// outermost rows, haze and sky. Throws Error (InvalidArgument) where nothing of one of them can be seen.
MergePlace merge_place(const Scene& host, const Scene& guest, const MergeWishes& wishes = {});

}  // namespace gse
