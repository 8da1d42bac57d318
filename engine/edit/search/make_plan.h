// From what was located to what the edit loop works on.
#pragma once

#include "engine/edit/interfaces/edit_plan.h"
#include "engine/edit/search/locate.h"

namespace gse::edit {

/// Plan of the edit loop for a located label. Masks are dilated as the request says and joined with the
/// label's own render. So a view whose mask missed part of the label does not pull it back.
EditPlan make_plan(const LocateInput& input, const LocateResult& located, raster::Rasterizer& rasterizer);

}  // namespace gse::edit
