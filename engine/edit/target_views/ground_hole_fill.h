// Rows for the holes that an object leaves in the scene when it goes (METHOD.md, Holes in the ground).
#pragma once

#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// One row per square of the surface that fills the holes of the views' clean plates (CleanPlate::filled).
/// The surface is a field of heights over the plane that fits the holes best, of the mean colour that they
/// were filled with. Squares that would hide visible rows behind them get none. Neither do those that hardly
/// any view has in a hole. `opacity` in (0,1).
GaussianData ground_hole_fill(const std::vector<EditView>& views, int sh_degree, double opacity = 0.95);

}  // namespace gse::edit
