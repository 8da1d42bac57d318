// Real Gaussians for the cells of a hole: copies of those at the cells' sources, on the surface's own
// heights.
#pragma once

#include "engine/heal/chart.h"
#include "engine/heal/patch_fill.h"

namespace gse::heal {

/// Smooth factors of the colours, per channel, with which copies meet the rim without a seam. They compare
/// the rim with what the shifts would put there, both blurred.
Grid<Vec3> rim_gain(const Chart& chart, const BitGrid& hole, const PatchFill& fill);

/// Appends the rows of the hole to `added`. Copies keep size, shape, opacity and view dependence; they are
/// turned with the surface. `gain`: factors of the rows' colours. Cells that stay thin get a row of the
/// fill's colour.
void lay_rows(const GaussianSet& scene, std::span<const SurfaceRow> rows, const Chart& chart,
              const BitGrid& hole, const PatchFill& fill, const Grid<Vec3>& rim_gains,
              std::span<const Vec3> gain, GaussianData& added);

/// Appends a copy of a scene's row at another place, turned by `turn`, with its colours times `gain`.
void append_copy(const GaussianSet& scene, std::size_t row, const Vec3& at, const Quat& turn,
                 const Vec3& gain, GaussianData& added);

}  // namespace gse::heal
