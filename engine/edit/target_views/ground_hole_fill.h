// What a thing stood on, where nobody ever saw it: rows for the holes that it leaves in the scene when it
// goes.
#pragma once

#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// One row per square of the surface that fills the holes of the views' backdrops (CleanPlate::filled): a
/// field of heights over the plane that fits the holes best, of the mean colour that they were filled with.
/// Squares that would hide what a view shows behind them, and those that hardly any view has in a hole, get
/// none. `opacity` in (0,1).
GaussianData ground_hole_fill(const std::vector<EditView>& views, int sh_degree, double opacity = 0.95);

}  // namespace gse::edit
