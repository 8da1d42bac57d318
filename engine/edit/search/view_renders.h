// Renders of the views of a scene.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/progress.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// One picture of each kind per view.
struct ViewRenders {
    std::vector<Image> renders;  // [H,W,3] in [0,1]
    std::vector<Image> depths;   // [H,W,1], 0 = nothing there
    std::vector<Image> grounds;  // [H,W,1] share of each pixel that shows a ground which is no part of the
                                 // scene; empty without one
};

/// Renders the views. `ground` is seen below and behind the scene in place of the background of `settings`.
/// Throws Error (Cancelled) on a stop request.
ViewRenders render_views(const GaussianSet& set, const std::vector<View>& views,
                         const raster::Settings& settings, const std::optional<StudioBackground>& ground,
                         raster::Rasterizer& rasterizer, const JobControl& job);

/// Pixels of that ground in the views.
struct GroundEvidence {
    double seen = 0;
    double inside = 0;  // the masks
};

}  // namespace gse::edit
