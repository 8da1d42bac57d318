// A value per row, and rows of one state in another.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/document.h"

namespace gse {

/// How far each row is from the base: 1 = a clear change of colour, place, size or opacity, or a new row.
std::vector<float> changed_values(const DocumentState& state);

/// Values of rows of a set carried to another one of `rows` rows; those that are new get `fresh`.
std::vector<float> carried(const std::vector<float>& values, const std::vector<std::int64_t>& base_to_new,
                           std::size_t rows, float fresh);

/// Where each row of `before` is in `after`, by identity; -1 = nowhere.
std::vector<std::int64_t> row_map(const std::vector<RowId>& before, const std::vector<RowId>& after);

}  // namespace gse
