// The result of an edit at the strength the request asks for.
#pragma once

#include "engine/edit/optimise/edit_loop.h"

namespace gse::edit {

/// Replaces the rows of the result by those at the strength (see with_strength()); rows outside the label
/// stay as they are to the bit. At 1 nothing is touched.
void apply_strength(const GaussianSet& base, double strength, EditResult& result);

}  // namespace gse::edit
