// A last phase of score distillation behind the redrawn views: it is kept only where views that were not
// redrawn say that it brought the scene nearer to what the model makes of them (views.md 10 and 13).
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/interfaces/snapshot.h"
#include "engine/raster/rasterizer.h"

namespace gse::edit {

/// A view that the fit never saw, as the model redrew it; the original outside the mask.
struct HeldOutView {
    Camera camera;
    Mask mask;
    Image target;  // [H,W,3]
};

/// What became of a polish.
struct PolishOutcome {
    int steps = 0;
    double before = -1, after = -1;  // see held_out_error()
    bool kept = false;               // else the result is the state before it
};

/// Mean absolute difference inside the masks between what the rows show in these views and their targets.
double held_out_error(const std::vector<HeldOutView>& views, const GaussianSpans& rows,
                      const raster::Settings& settings, raster::Rasterizer& rasterizer);

/// The state that a polish begins at, and what both states are judged by.
class Polish {
public:
    /// `views`: at least one.
    Polish(std::vector<HeldOutView> views, EditSnapshot before, const GaussianSpans& rows,
           const raster::Settings& settings, raster::Rasterizer& rasterizer);
    /// Another state to begin at: the label has changed, and with it what may.
    void begin_anew(EditSnapshot before, const GaussianSpans& rows, const raster::Settings& settings,
                    raster::Rasterizer& rasterizer);
    int first_iteration() const { return before_.iteration; }
    const EditSnapshot& before() const { return before_; }
    /// Judges the rows as they have become and says what came of it.
    PolishOutcome judged(int steps, const GaussianSpans& rows, const raster::Settings& settings,
                         raster::Rasterizer& rasterizer) const;

private:
    std::vector<HeldOutView> views_;
    EditSnapshot before_;
    double error_before_ = 0;
};

}  // namespace gse::edit
