// Checks of every finished edit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/edit/optimise/edit_loop.h"

namespace gse::edit {

/// Rows outside the label that are missing or differ in any bit.
std::size_t count_changed_outside(const GaussianSet& base, const std::vector<std::uint8_t>& label,
                                  const EditResult& result);

/// Labelled rows with a NaN or infinity.
std::size_t count_nonfinite(const EditResult& result);

}  // namespace gse::edit
