// Real Gaussians for the cells of a hole: copies of those at the cells' sources, on the surface's own
// heights.
#pragma once

#include "engine/heal/chart.h"
#include "engine/heal/patch_fill.h"

namespace gse::heal {

/// Smooth colour that copies need so that they meet the rim without a seam.
Grid<Vec3> rim_correction(const Chart& chart, const BitGrid& hole, const PatchFill& fill);

/// Appends the rows of the hole to `added`. Copies keep size, shape, opacity and view dependence; they are
/// turned with the surface. `gain`: factors of the rows' colours. Cells that stay thin get a row of the
/// fill's colour.
void lay_rows(const GaussianSet& scene, std::span<const SurfaceRow> rows, const Chart& chart,
              const BitGrid& hole, const PatchFill& fill, const Grid<Vec3>& correction,
              std::span<const Vec3> gain, GaussianData& added);

/// Appends a copy of a scene's row with another place, turned by `turn`, its base colour times `gain` plus
/// `more`.
void append_copy(const GaussianSet& scene, std::size_t row, const Vec3& at, const Quat& turn,
                 const Vec3& gain, const Vec3& more, GaussianData& added);

}  // namespace gse::heal
