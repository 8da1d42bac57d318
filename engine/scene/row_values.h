// Values per row, and rows of one state in another.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/document.h"

namespace gse {

/// Distance of each row from the base: 1 = a clear change of colour, place, size or opacity, or a new row.
std::vector<float> changed_values(const DocumentState& state);

/// Values of a set's rows carried to another set of `rows` rows. New rows get `fresh`.
std::vector<float> carried(const std::vector<float>& values, const std::vector<std::int64_t>& base_to_new,
                           std::size_t rows, float fresh);

/// Place in `after` of each row of `before`, by identity; -1 = none.
std::vector<std::int64_t> row_map(const std::vector<RowId>& before, const std::vector<RowId>& after);

/// Rows through two maps one after the other; -1 = none.
std::vector<std::int64_t> chained(std::vector<std::int64_t> first, const std::vector<std::int64_t>& second);

}  // namespace gse
