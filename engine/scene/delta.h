// An edit as the difference between two sets of Gaussians: changed, removed and added rows, by identity, so that edits of a
// stack can be switched on and off on their own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse {

/// Identity of a row for the whole life of a document: rows of the base are 0..N-1, rows that edit `e` added are
/// (e << 32) | index.
using RowId = std::uint64_t;

struct SceneDelta {
    std::vector<RowId> changed;        // ascending
    GaussianData changed_rows;         // [changed.size()] their new values
    std::vector<RowId> removed;        // ascending
    std::vector<RowId> added;          // identities of the new rows
    GaussianData added_rows;           // [added.size()]

    std::size_t byte_size() const;
};

/// The difference. base_to_new[row] is the row of `after` that `before`'s row became, -1 = removed; rows of `after` that no
/// row maps to are new and get identities of edit `edit_id`. Bit-identical rows do not enter.
SceneDelta make_delta(const GaussianSet& before, std::span<const RowId> before_ids, const GaussianSet& after,
                      std::span<const std::int64_t> base_to_new, std::uint64_t edit_id);

/// Applies it; rows it names that are not there (their edit is switched off) are passed over. Order: the rows that stay, in
/// their order, then the added ones. Both SH degrees must agree (a delta of a lower degree is widened with zeros).
std::pair<GaussianSet, std::vector<RowId>> apply_delta(const GaussianSet& set, std::span<const RowId> ids,
                                                       const SceneDelta& delta);

}  // namespace gse
