// An edit as the difference between two sets of Gaussians: changed, removed and added rows, by identity.
// Edits of a stack can be switched on and off on their own.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse {

/// Identity of a row for the whole life of a document. Rows of the base are 0..N-1; rows that edit `e` added
/// are (e << 32) | index.
using RowId = std::uint64_t;
constexpr int EditIdShift = 32;

struct SceneDelta {
    std::vector<RowId> changed;  // ascending
    GaussianData changed_rows;   // [changed.size()] their new values
    std::vector<RowId> removed;  // ascending
    std::vector<RowId> added;    // identities of the new rows
    GaussianData added_rows;     // [added.size()]

    std::size_t byte_size() const;
};

/// Difference of two sets. base_to_new[row] is the row of `after` that `before`'s row became, -1 = removed.
/// Rows of `after` that no row maps to are new and get identities of edit `edit_id`. Rows that are equal bit
/// for bit do not enter.
SceneDelta make_delta(const GaussianSet& before, std::span<const RowId> before_ids, const GaussianSet& after,
                      std::span<const std::int64_t> base_to_new, std::uint64_t edit_id);

/// Applies the delta. Rows it names that are not there (their edit is switched off) are passed over. The rows
/// that stay keep their order; added ones follow. Both SH degrees must agree; a delta of a lower degree is
/// widened with zeros.
std::pair<GaussianSet, std::vector<RowId>> apply_delta(const GaussianSet& set, std::span<const RowId> ids,
                                                       const SceneDelta& delta);

/// True when every attribute agrees bit for bit. Of two SH degrees the higher one must go on with zeros.
bool same_row(const GaussianSpans& a, std::size_t a_row, const GaussianSpans& b, std::size_t b_row);

/// Applies several deltas, oldest first, with the result of single calls. Each array is copied at most once
/// while no rows come or go.
std::pair<GaussianSet, std::vector<RowId>> apply_deltas(const GaussianSet& set, std::span<const RowId> ids,
                                                        std::span<const SceneDelta* const> deltas);

/// Calls visit(row, k) for every row whose identity is wanted[k], rows ascending. `wanted` must ascend. `ids`
/// may be in any order; long ascending stretches are fast.
template <class F> void locate_rows(std::span<const RowId> ids, std::span<const RowId> wanted, F&& visit) {
    std::size_t begin = 0;
    while (begin < ids.size() && !wanted.empty()) {
        std::size_t end = begin + 1;
        while (end < ids.size() && ids[end] > ids[end - 1]) ++end;
        auto k = static_cast<std::size_t>(std::lower_bound(wanted.begin(), wanted.end(), ids[begin]) -
                                          wanted.begin());
        for (std::size_t row = begin; k < wanted.size() && wanted[k] <= ids[end - 1]; ++k) {
            std::size_t step = 1;  // gallop: the next one is near
            while (row + step < end && ids[row + step] <= wanted[k]) step *= 2;
            const auto from = ids.begin() + static_cast<std::ptrdiff_t>(row + step / 2);
            const auto to = ids.begin() + static_cast<std::ptrdiff_t>(std::min(row + step, end));
            row = static_cast<std::size_t>(std::lower_bound(from, to, wanted[k]) - ids.begin());
            if (row < end && ids[row] == wanted[k]) visit(row, k);
            if (row == end) break;
        }
        begin = end;
    }
}

}  // namespace gse
