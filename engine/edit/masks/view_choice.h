// Which views are redrawn: far from each other, and showing enough of what may change.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::edit {

/// Indices of the views to redraw, ascending. They are a farthest-point sample of the cameras that see enough
/// of the label, starting with the view that shows most of it. `covered`: share of each view's picture.
std::vector<std::size_t> views_to_redraw(const std::vector<View>& views, const std::vector<double>& covered,
                                         std::size_t count);

}  // namespace gse::edit
