// From a finished edit to a weaker or stronger one: its delta at a strength, and what every row of that came
// from.
#include "engine/edit/optimise/edit_strength.h"

#include <numeric>

#include "engine/scene/strength.h"

namespace gse::edit {

void apply_strength(const GaussianSet& base, double strength, EditResult& result) {
    if (strength == 1) return;
    std::vector<RowId> ids(base.size());
    std::iota(ids.begin(), ids.end(), RowId{0});
    const SceneDelta delta = make_delta(base, ids, result.set, result.base_to_new, 1);
    auto [set, rows] = apply_delta(base, ids, with_strength(base, ids, delta, strength));
    std::vector<std::uint8_t> has_origin(result.set.size(), 0);
    for (const std::int64_t row : result.base_to_new)
        if (row >= 0) has_origin[static_cast<std::size_t>(row)] = 1;
    std::vector<std::size_t> born;
    for (std::size_t row = 0; row < has_origin.size(); ++row)
        if (has_origin[row] == 0) born.push_back(row);

    std::vector<std::int64_t> base_to_new(base.size(), -1);
    std::vector<std::uint8_t> label, hole_fill;
    std::vector<int> generation;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const bool added = rows[row] >= base.size();
        if (!added) base_to_new[rows[row]] = static_cast<std::int64_t>(row);
        const std::int64_t was =
            added ? static_cast<std::int64_t>(born[rows[row] & ((RowId{1} << EditIdShift) - 1)])
                  : result.base_to_new[rows[row]];
        label.push_back(was < 0 ? 1
                                : result.label[static_cast<std::size_t>(was)]);  // removed, and back again
        hole_fill.push_back(was < 0 ? 0 : result.hole_fill[static_cast<std::size_t>(was)]);
        generation.push_back(was < 0 ? 0 : result.generation[static_cast<std::size_t>(was)]);
    }
    result.set = std::move(set);
    result.base_to_new = std::move(base_to_new);
    result.label = std::move(label);
    result.hole_fill = std::move(hole_fill);
    result.generation = std::move(generation);
}

}  // namespace gse::edit
